// The wire: packets, and one end of it.
#include "palmbots/wire.hpp"

#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <optional>
#include <span>

#include "bindings.hpp"
#include "palmbots/endpoint.hpp"

namespace palmbots::bindings {

namespace {

using Stamp = std::tuple<std::uint32_t, std::uint32_t>;
// Kind, sender, receiver, pair, stamp, stamp heard, payload.
using Fields = std::tuple<int, int, int, int, Stamp, Stamp, int>;

constexpr const char* verdicts[] = {"accepted", "other_version", "too_short", "too_long",
                                    "stranger", "misdirected",   "forged",    "malformed",
                                    "stale",    "unanswered"};
static_assert(std::size(verdicts) == wire::verdict_count);

int number(auto value) { return static_cast<int>(value); }

wire::Key key_of(const nb::bytes& bytes) {
  wire::Key key{};
  if (bytes.size() != key.size()) throw std::out_of_range("a key has 16 bytes");
  std::copy_n(static_cast<const std::uint8_t*>(bytes.data()), key.size(), key.begin());
  return key;
}

std::span<const std::uint8_t> span_of(const nb::bytes& bytes) {
  return {static_cast<const std::uint8_t*>(bytes.data()), bytes.size()};
}

std::optional<nb::bytes> bytes_or_none(bool written, const wire::Bytes& bytes) {
  if (!written) return std::nullopt;
  return nb::bytes(bytes.data(), bytes.size());
}

std::tuple<std::string, Fields> told(const wire::Decoded& decoded) {
  const wire::Packet& p = decoded.packet;
  return {verdicts[number(decoded.verdict)],
          {number(p.kind),
           number(p.sender),
           number(p.receiver),
           p.pair,
           {p.sent.epoch, p.sent.sequence},
           {p.heard.epoch, p.heard.sequence},
           p.payload}};
}

}  // namespace

void bind_wire(nb::module_& m) {
  m.def(
      "wire_layout",
      [] {
        std::vector<std::tuple<std::string, std::size_t, std::size_t>> rows;
        for (const auto& field : wire::layout) {
          rows.emplace_back(field.name, field.offset, field.size);
        }
        return rows;
      },
      "The fields of a packet: name, offset and size [bytes].");
  m.def(
      "wire_encode",
      [](const nb::bytes& key, std::uint8_t kind, std::uint8_t sender, std::uint8_t receiver,
         std::uint16_t pair, const Stamp& sent, const Stamp& heard, std::uint8_t payload) {
        const wire::Packet packet{static_cast<wire::Kind>(kind),
                                  static_cast<wire::Role>(sender),
                                  static_cast<wire::Role>(receiver),
                                  pair,
                                  {std::get<0>(sent), std::get<1>(sent)},
                                  {std::get<0>(heard), std::get<1>(heard)},
                                  payload};
        wire::Bytes bytes{};
        const bool written = wire::encode(packet, key_of(key), bytes);
        return bytes_or_none(written, bytes);
      },
      nb::arg("key"), nb::arg("kind"), nb::arg("sender"), nb::arg("receiver"), nb::arg("pair"),
      nb::arg("sent"), nb::arg("heard"), nb::arg("payload"),
      "The bytes of a packet, or None if it is not well formed.");
  m.def(
      "wire_decode",
      [](const nb::bytes& bytes, const nb::bytes& key, std::uint16_t pair, std::uint8_t receiver) {
        return told(
            wire::decode(span_of(bytes), key_of(key), pair, static_cast<wire::Role>(receiver)));
      },
      nb::arg("bytes"), nb::arg("key"), nb::arg("pair"), nb::arg("receiver"),
      "The verdict on some bytes, and the fields, all 0 unless accepted: kind, sender, receiver, "
      "pair, (epoch, sequence) sent and heard, payload.");
  m.def(
      "wire_report",
      [](int sign, std::uint8_t palm, bool turned) {
        return wire::payload(
            Centralized::Report{static_cast<Sign>(sign), static_cast<Palm>(palm), turned});
      },
      nb::arg("sign"), nb::arg("palm"), nb::arg("turned"), "The payload of a report.");
  m.def(
      "wire_report_of",
      [](std::uint8_t payload) {
        const auto report = wire::report_of(payload);
        return std::tuple(number(report.sign), number(report.palm), report.turned);
      },
      nb::arg("payload"), "A report: sign, palm, turned.");
  m.def(
      "wire_beacon",
      [](char letter, bool rests, bool ready) {
        return wire::payload(wire::Beacon{letter, rests, ready});
      },
      nb::arg("letter"), nb::arg("rests"), nb::arg("ready"), "The payload of a beacon.");
  m.def(
      "wire_beacon_of",
      [](std::uint8_t payload) {
        const auto beacon = wire::beacon_of(payload);
        return std::tuple(std::string(1, beacon.letter), beacon.rests, beacon.ready);
      },
      nb::arg("payload"), "A beacon: letter, rests, ready.");
  m.def(
      "wire_command",
      [](std::uint8_t palm, std::uint8_t move) {
        return wire::payload(Command{static_cast<Palm>(palm), static_cast<Move>(move)});
      },
      nb::arg("palm"), nb::arg("move"), "The payload of a command.");
  m.def(
      "wire_command_of",
      [](std::uint8_t payload) {
        const auto command = wire::command_of(payload);
        return std::tuple(number(command.palm), number(command.move));
      },
      nb::arg("payload"), "A command: palm, move.");

  nb::class_<wire::Endpoint>(m, "WireEndpoint", "One end of the wire.")
      .def(
          "__init__",
          [](wire::Endpoint* self, const nb::bytes& key, std::uint16_t pair, std::uint8_t role,
             std::uint32_t epoch) {
            new (self) wire::Endpoint({key_of(key), pair, static_cast<wire::Role>(role)}, epoch);
          },
          nb::arg("key"), nb::arg("pair"), nb::arg("role"), nb::arg("epoch"))
      .def(
          "send",
          [](wire::Endpoint& self, std::uint8_t receiver, std::uint8_t kind, std::uint8_t payload) {
            wire::Bytes bytes{};
            const bool written = self.send(static_cast<wire::Role>(receiver),
                                           static_cast<wire::Kind>(kind), payload, bytes);
            return bytes_or_none(written, bytes);
          },
          nb::arg("receiver"), nb::arg("kind"), nb::arg("payload"),
          "The next packet, or None if it is not well formed.")
      .def(
          "receive",
          [](wire::Endpoint& self, const nb::bytes& bytes) {
            return told(self.receive(span_of(bytes)));
          },
          nb::arg("bytes"), "The verdict and the fields, as wire_decode.")
      .def_prop_ro("counts", [](const wire::Endpoint& self) {
        std::vector<std::tuple<std::string, std::uint32_t>> counts;
        for (std::size_t i = 0; i < wire::verdict_count; ++i) {
          counts.emplace_back(verdicts[i], self.count(static_cast<wire::Verdict>(i)));
        }
        return counts;
      });
}

}  // namespace palmbots::bindings
