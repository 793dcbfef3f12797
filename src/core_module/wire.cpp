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
using Fields = std::tuple<int, int, int, int, StampTuple, StampTuple, nb::bytes>;

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

nb::bytes bytes_of(const wire::Payload& payload) {
  return nb::bytes(payload.data(), payload.size());
}

wire::Payload payload_in(const nb::bytes& bytes) {
  wire::Payload payload{};
  if (bytes.size() != payload.size()) throw std::out_of_range("a payload has 5 bytes");
  std::copy_n(static_cast<const std::uint8_t*>(bytes.data()), payload.size(), payload.begin());
  return payload;
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
           bytes_of(p.payload)}};
}

// The payload of each kind from its content, and back.
void bind_payloads(nb::module_& m) {
  m.def(
      "hello",
      [](std::uint32_t settings, bool stop) {
        return bytes_of(wire::payload_of(wire::Hello{settings, stop}));
      },
      nb::arg("settings"), nb::arg("stop"), "The payload of a hello.");
  m.def(
      "hello_of",
      [](const nb::bytes& payload) {
        const wire::Hello hello = wire::hello_of(payload_in(payload));
        return std::tuple(hello.settings, hello.stop);
      },
      nb::arg("payload"), "A hello: settings, stop.");
  m.def(
      "state",
      [](std::uint8_t language, std::uint8_t message, std::uint8_t mode, bool ready, bool at_rest,
         bool stop) {
        return bytes_of(wire::payload_of(
            wire::State{static_cast<wire::Language>(language), static_cast<MessageKind>(message),
                        static_cast<wire::RobotMode>(mode), ready, at_rest, stop}));
      },
      nb::arg("language"), nb::arg("message"), nb::arg("mode"), nb::arg("ready"),
      nb::arg("at_rest"), nb::arg("stop"), "The payload of a state.");
  m.def(
      "state_of",
      [](const nb::bytes& payload) {
        const wire::State s = wire::state_of(payload_in(payload));
        return std::tuple(number(s.language), number(s.message), number(s.mode), s.ready, s.at_rest,
                          s.stop);
      },
      nb::arg("payload"), "A state: language, message, mode, ready, at rest, stop.");
  m.def(
      "status",
      [](std::uint8_t mode, std::uint8_t fault, int sign, std::uint8_t palm, bool palm_at_target,
         char activity, std::uint8_t item, std::uint16_t value, bool ready, bool at_rest,
         bool stop) {
        return bytes_of(wire::payload_of(
            wire::Status{static_cast<wire::RobotMode>(mode), static_cast<wire::FaultCode>(fault),
                         static_cast<Sign>(sign), static_cast<Palm>(palm), palm_at_target, activity,
                         static_cast<wire::StatusItem>(item), value, ready, at_rest, stop}));
      },
      nb::arg("mode"), nb::arg("fault"), nb::arg("sign"), nb::arg("palm"),
      nb::arg("palm_at_target"), nb::arg("activity"), nb::arg("item"), nb::arg("value"),
      nb::arg("ready"), nb::arg("at_rest"), nb::arg("stop"), "The payload of a status.");
  m.def(
      "status_of",
      [](const nb::bytes& payload) {
        const wire::Status s = wire::status_of(payload_in(payload));
        return std::tuple(number(s.mode), number(s.fault), number(s.sign), number(s.palm),
                          s.palm_at_target, std::string(1, s.activity), number(s.item), s.value,
                          s.ready, s.at_rest, s.stop);
      },
      nb::arg("payload"),
      "A status: mode, fault, sign, palm, palm at target, case, item, value, ready, at rest, "
      "stop.");
  m.def(
      "operate",
      [](std::uint8_t operation, bool stop) {
        return bytes_of(
            wire::payload_of(wire::Operate{static_cast<wire::Operation>(operation), stop}));
      },
      nb::arg("operation"), nb::arg("stop"), "The payload of a wish of the operator.");
  m.def(
      "operate_of",
      [](const nb::bytes& payload) {
        const wire::Operate wish = wire::operate_of(payload_in(payload));
        return std::tuple(number(wish.operation), wish.stop);
      },
      nb::arg("payload"), "A wish of the operator: operation, stop.");
  m.def(
      "report",
      [](int sign, std::uint8_t palm, bool palm_at_target, bool stop) {
        return bytes_of(wire::payload_of(
            Centralized::Report{static_cast<Sign>(sign), static_cast<Palm>(palm), palm_at_target},
            stop));
      },
      nb::arg("sign"), nb::arg("palm"), nb::arg("palm_at_target"), nb::arg("stop"),
      "The payload of a report.");
  m.def(
      "report_of",
      [](const nb::bytes& bytes) {
        const wire::Payload payload = payload_in(bytes);
        const auto report = wire::report_of(payload);
        return std::tuple(number(report.sign), number(report.palm), report.palm_at_target,
                          wire::passes_stop(payload));
      },
      nb::arg("payload"), "A report: sign, palm, palm at target, stop.");
  m.def(
      "command",
      [](std::uint8_t palm, std::uint8_t move, bool stop) {
        return bytes_of(
            wire::payload_of(Command{static_cast<Palm>(palm), static_cast<Move>(move)}, stop));
      },
      nb::arg("palm"), nb::arg("move"), nb::arg("stop"), "The payload of a command.");
  m.def(
      "command_of",
      [](const nb::bytes& bytes) {
        const wire::Payload payload = payload_in(bytes);
        const auto command = wire::command_of(payload);
        return std::tuple(number(command.palm), number(command.move), wire::passes_stop(payload));
      },
      nb::arg("payload"), "A command: palm, move, stop.");
}

// Names of an enumeration: as a tuple, and as a type (write_stubs.py).
void put_names(nb::module_& m, const char* all, const char* type, const nb::tuple& names) {
  m.attr(all) = names;
  m.attr(type) = nb::module_::import_("typing").attr("Literal")[names];
}

}  // namespace

void bind_wire(nb::module_& core) {
  nb::module_ m = core.def_submodule("wire", "Packets, and one end of the wire.");
  put_names(m, "packet_kinds", "Kind", names_to(wire::PacketKind::phase));
  put_names(m, "roles", "Role", names_to(wire::Role::station));
  put_names(m, "verdicts", "Verdict", names_to(wire::Verdict::no_session));
  put_names(m, "languages", "Language", names_to(wire::Language::phases));
  m.def(
      "has_message",
      [](std::uint8_t language, std::uint8_t message) {
        return wire::has_message(static_cast<wire::Language>(language),
                                 static_cast<MessageKind>(message));
      },
      nb::arg("language"), nb::arg("message"), "Whether the language has this message.");
  put_names(m, "messages", "MessageName", names_to(MessageKind::holding));
  put_names(m, "robot_modes", "RobotMode", names_to(wire::RobotMode::fault));
  put_names(m, "fault_codes", "FaultCode", names_to(wire::FaultCode::job));
  put_names(m, "operations", "Operation", names_to(wire::Operation::release));
  m.attr("status_numbers") = nb::make_tuple("progress", "battery", "overruns", "sent", "phase");
  m.attr("cases") = std::string(wire::case_names, sizeof wire::case_names);
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
         const nb::bytes& payload) {
        const wire::Packet packet{static_cast<wire::PacketKind>(kind),
                                  static_cast<wire::Role>(sender),
                                  static_cast<wire::Role>(receiver),
                                  pair,
                                  {std::get<0>(sent), std::get<1>(sent)},
                                  {std::get<0>(heard), std::get<1>(heard)},
                                  payload_in(payload)};
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
      "The verdict on some bytes, and the fields, all 0 unless authentic: kind, sender, receiver, "
      "pair, (epoch, sequence) sent and heard, payload.");
  m.def(
      "retagged",
      [](const nb::bytes& bytes, const nb::bytes& key) {
        wire::Bytes packet{};
        if (bytes.size() != packet.size()) throw std::out_of_range("a packet has 32 bytes");
        std::copy_n(static_cast<const std::uint8_t*>(bytes.data()), packet.size(), packet.begin());
        wire::retag(packet, key_of(key));
        return nb::bytes(packet.data(), packet.size());
      },
      nb::arg("bytes"), nb::arg("key"), "The same packet with the tag of another key.");
  std::vector<std::string> authentic;
  for (std::size_t i = 0; i < wire::verdict_count; ++i) {
    const auto verdict = static_cast<wire::Verdict>(i);
    if (wire::is_authentic(verdict)) authentic.emplace_back(name_of(verdict));
  }
  m.attr("authentic") = nb::tuple(nb::cast(authentic));
  bind_payloads(m);

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
          [](wire::Endpoint& self, std::uint8_t receiver, std::uint8_t kind,
             const nb::bytes& payload) {
            wire::Bytes bytes{};
            const bool written =
                self.send(static_cast<wire::Role>(receiver), static_cast<wire::PacketKind>(kind),
                          payload_in(payload), bytes);
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
      .def(
          "skip_to",
          [](wire::Endpoint& self, std::uint8_t receiver, std::uint32_t sequence) {
            self.skip_to(static_cast<wire::Role>(receiver), sequence);
          },
          nb::arg("receiver"), nb::arg("sequence"),
          "The next packet to this receiver gets this sequence number, unless it has been used.")
      .def(
          "newest",
          [](const wire::Endpoint& self, std::uint8_t receiver) {
            const wire::SequenceNumber stamp = self.newest(static_cast<wire::Role>(receiver));
            return StampTuple(stamp.epoch, stamp.sequence);
          },
          nb::arg("receiver"), "(epoch, sequence) of the newest packet to this receiver.")
      .def(
          "claimed_epoch",
          [](const wire::Endpoint& self, std::uint8_t other) {
            return self.session(static_cast<wire::Role>(other)).claimed_epoch();
          },
          nb::arg("other"), "The highest epoch of this end that the other end has named.")
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
