// SPDX-License-Identifier: Apache-2.0
// The wire: packets, and one end of it.
#include "palmbots/wire/packet.hpp"

#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <optional>
#include <span>

#include "bindings.hpp"
#include "palmbots/wire/endpoint.hpp"

namespace palmbots::bindings {

namespace {

using StampTuple = std::tuple<std::uint32_t, std::uint32_t>;
// Kind, sender, receiver, pair, stamp, stamp heard, payload.
using Fields = std::tuple<int, int, int, int, StampTuple, StampTuple, int>;

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

std::tuple<std::string, Fields> verdict_and_fields(const wire::Decoded& decoded) {
  const wire::Packet& p = decoded.packet;
  return {name_of(decoded.verdict),
          {number(p.kind),
           number(p.sender),
           number(p.receiver),
           p.pair,
           {p.sent.epoch, p.sent.sequence},
           {p.heard.epoch, p.heard.sequence},
           p.payload}};
}

}  // namespace

void bind_wire(nb::module_& core) {
  nb::module_ m = core.def_submodule("wire", "Packets, and one end of the wire.");
  m.attr("packet_kinds") = names_to(wire::PacketKind::sign);
  m.attr("roles") = names_to(wire::Role::station);
  m.attr("verdicts") = names_to(wire::Verdict::no_session);
  m.def(
      "layout",
      [] {
        std::vector<std::tuple<std::string, std::size_t, std::size_t>> rows;
        for (const auto& field : wire::layout) {
          rows.emplace_back(field.name, field.offset, field.size);
        }
        return rows;
      },
      "The fields of a packet: name, offset and size [bytes].");
  m.def(
      "encode",
      [](const nb::bytes& key, std::uint8_t kind, std::uint8_t sender, std::uint8_t receiver,
         std::uint16_t pair, const StampTuple& sent, const StampTuple& heard,
         std::uint8_t payload) {
        const wire::Packet packet{static_cast<wire::PacketKind>(kind),
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
      "decode",
      [](const nb::bytes& bytes, const nb::bytes& key, std::uint16_t pair, std::uint8_t receiver) {
        return verdict_and_fields(
            wire::decode(span_of(bytes), key_of(key), pair, static_cast<wire::Role>(receiver)));
      },
      nb::arg("bytes"), nb::arg("key"), nb::arg("pair"), nb::arg("receiver"),
      "The verdict on some bytes, and the fields, all 0 unless accepted: kind, sender, receiver, "
      "pair, (epoch, sequence) sent and heard, payload.");
  m.def(
      "report",
      [](int sign, std::uint8_t palm, bool palm_at_target) {
        return wire::payload(
            Centralized::Report{static_cast<Sign>(sign), static_cast<Palm>(palm), palm_at_target});
      },
      nb::arg("sign"), nb::arg("palm"), nb::arg("palm_at_target"), "The payload of a report.");
  m.def(
      "report_of",
      [](std::uint8_t payload) {
        const auto report = wire::report_of(payload);
        return std::tuple(number(report.sign), number(report.palm), report.palm_at_target);
      },
      nb::arg("payload"), "A report: sign, palm, palm at target.");
  m.def(
      "beacon",
      [](char letter, bool stopped, bool ready) {
        return wire::payload(wire::Beacon{letter, stopped, ready});
      },
      nb::arg("letter"), nb::arg("stopped"), nb::arg("ready"), "The payload of a beacon.");
  m.def(
      "beacon_of",
      [](std::uint8_t payload) {
        const auto beacon = wire::beacon_of(payload);
        return std::tuple(std::string(1, beacon.letter), beacon.stopped, beacon.ready);
      },
      nb::arg("payload"), "A beacon: letter, stopped, ready.");
  m.def(
      "command",
      [](std::uint8_t palm, std::uint8_t move) {
        return wire::payload(Command{static_cast<Palm>(palm), static_cast<Move>(move)});
      },
      nb::arg("palm"), nb::arg("move"), "The payload of a command.");
  m.def(
      "command_of",
      [](std::uint8_t payload) {
        const auto command = wire::command_of(payload);
        return std::tuple(number(command.palm), number(command.move));
      },
      nb::arg("payload"), "A command: palm, move.");
  m.def(
      "sign",
      [](int sign, std::uint8_t palm) {
        return wire::payload(wire::SignWord{static_cast<Sign>(sign), palm != 0});
      },
      nb::arg("sign"), nb::arg("palm"), "The payload of a sign.");
  m.def(
      "sign_of",
      [](std::uint8_t payload) {
        const auto word = wire::sign_of(payload);
        return std::tuple(number(word.sign), int{word.shallow});
      },
      nb::arg("payload"), "A sign: sign, palm.");

  nb::class_<wire::Endpoint>(m, "Endpoint", "One end of the wire.")
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
                                           static_cast<wire::PacketKind>(kind), payload, bytes);
            return bytes_or_none(written, bytes);
          },
          nb::arg("receiver"), nb::arg("kind"), nb::arg("payload"),
          "The next packet, or None if it is not well formed.")
      .def(
          "receive",
          [](wire::Endpoint& self, const nb::bytes& bytes) {
            return verdict_and_fields(self.receive(span_of(bytes)));
          },
          nb::arg("bytes"), "The verdict and the fields, as decode.")
      .def_prop_ro("counts", [](const wire::Endpoint& self) {
        std::vector<std::tuple<std::string, std::uint32_t>> counts;
        for (std::size_t i = 0; i < wire::verdict_count; ++i) {
          counts.emplace_back(name_of(static_cast<wire::Verdict>(i)),
                              self.count(static_cast<wire::Verdict>(i)));
        }
        return counts;
      });
}

}  // namespace palmbots::bindings
