// SPDX-License-Identifier: Apache-2.0
// Frames on a serial line, and what they contain.
#include <nanobind/stl/optional.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <array>
#include <optional>
#include <span>
#include <tuple>
#include <utility>
#include <vector>

#include "bindings.hpp"
#include "palmbots/wire/device_frames.hpp"
#include "palmbots/wire/serial_frame.hpp"

namespace palmbots::bindings {

namespace {

std::span<const std::uint8_t> span_of(const nb::bytes& bytes) {
  return {static_cast<const std::uint8_t*>(bytes.data()), bytes.size()};
}

nb::bytes bytes_of(std::span<const std::uint8_t> bytes) {
  return nb::bytes(bytes.data(), bytes.size());
}

// What `in` reads from some content, as the tuple that `fields` makes of it; nothing if it is
// malformed.
template <class Value, class Fields>
auto read(bool (*in)(wire::Content, Value&), const nb::bytes& content, const Fields& fields)
    -> std::optional<decltype(fields(std::declval<const Value&>()))> {
  Value value;
  if (!in(span_of(content), value)) return std::nullopt;
  return fields(std::as_const(value));
}

void bind_contents(nb::module_& m) {
  m.def(
      "bridge_report",
      [](std::uint32_t sent, std::uint32_t received, std::uint32_t radio_full,
         std::uint32_t serial_full, std::uint32_t radio_damaged, std::uint32_t serial_damaged) {
        return bytes_of(wire::content_of(wire::BridgeReport{sent, received, radio_full, serial_full,
                                                            radio_damaged, serial_damaged}));
      },
      nb::arg("sent"), nb::arg("received"), nb::arg("radio_full"), nb::arg("serial_full"),
      nb::arg("radio_damaged"), nb::arg("serial_damaged"), "The content of a bridge's report.");
  m.def(
      "bridge_report_in",
      [](const nb::bytes& content) {
        return read(wire::bridge_report_in, content, [](const wire::BridgeReport& r) {
          return std::tuple(r.sent, r.received, r.radio_full, r.serial_full, r.radio_damaged,
                            r.serial_damaged);
        });
      },
      nb::arg("content"), "A bridge's report, in the order of `bridge_report`; None: malformed.");
  m.def(
      "board_identity",
      [](std::uint8_t version, bool has_encoders, bool measures_palm, bool measures_battery,
         std::uint8_t switches, std::uint16_t longest_watchdog) {
        return bytes_of(wire::content_of(wire::BoardIdentity{
            version, has_encoders, measures_palm, measures_battery, switches, longest_watchdog}));
      },
      nb::arg("version"), nb::arg("has_encoders"), nb::arg("measures_palm"),
      nb::arg("measures_battery"), nb::arg("switches"), nb::arg("longest_watchdog"),
      "The content of a motor board's identity.");
  m.def(
      "board_identity_in",
      [](const nb::bytes& content) {
        return read(wire::board_identity_in, content, [](const wire::BoardIdentity& b) {
          return std::tuple(b.version, b.has_encoders, b.measures_palm, b.measures_battery,
                            b.switches, b.longest_watchdog);
        });
      },
      nb::arg("content"), "An identity, in the order of `board_identity`; None: malformed.");
  m.def(
      "board_command",
      [](std::uint8_t number, bool wheels, bool palm, std::uint16_t watchdog,
         std::int16_t left_speed, std::int16_t right_speed, std::int16_t palm_angle) {
        return bytes_of(wire::content_of(wire::BoardCommand{number, wheels, palm, watchdog,
                                                            left_speed, right_speed, palm_angle}));
      },
      nb::arg("number"), nb::arg("wheels"), nb::arg("palm"), nb::arg("watchdog"),
      nb::arg("left_speed"), nb::arg("right_speed"), nb::arg("palm_angle"),
      "The content of a command to a motor board.");
  m.def(
      "board_command_in",
      [](const nb::bytes& content) {
        return read(wire::board_command_in, content, [](const wire::BoardCommand& c) {
          return std::tuple(c.number, c.wheels, c.palm, c.watchdog, c.left_speed, c.right_speed,
                            c.palm_angle);
        });
      },
      nb::arg("content"), "A command, in the order of `board_command`; None: malformed.");
  m.def(
      "board_reading",
      [](std::uint8_t number, bool watchdog_acts, std::uint16_t time, std::uint16_t switches,
         std::int16_t palm_angle, std::int32_t left_count, std::int32_t right_count,
         std::uint16_t battery, std::uint16_t damaged) {
        return bytes_of(
            wire::content_of(wire::BoardReading{number, watchdog_acts, time, switches, palm_angle,
                                                left_count, right_count, battery, damaged}));
      },
      nb::arg("number"), nb::arg("watchdog_acts"), nb::arg("time"), nb::arg("switches"),
      nb::arg("palm_angle"), nb::arg("left_count"), nb::arg("right_count"), nb::arg("battery"),
      nb::arg("damaged"), "The content of a motor board's reading.");
  m.def(
      "board_reading_in",
      [](const nb::bytes& content) {
        return read(wire::board_reading_in, content, [](const wire::BoardReading& r) {
          return std::tuple(r.number, r.watchdog_acts, r.time, r.switches, r.palm_angle,
                            r.left_count, r.right_count, r.battery, r.damaged);
        });
      },
      nb::arg("content"), "A reading, in the order of `board_reading`; None: malformed.");
}

}  // namespace

void bind_serial_frames(nb::module_& core) {
  nb::module_ m = core.def_submodule("serial", "Frames on a serial line.");
  m.attr("kinds") = nb::make_tuple(
      nb::make_tuple("packet", static_cast<int>(wire::FrameKind::packet)),
      nb::make_tuple("bridge_report", static_cast<int>(wire::FrameKind::bridge_report)),
      nb::make_tuple("board_hello", static_cast<int>(wire::FrameKind::board_hello)),
      nb::make_tuple("board_identity", static_cast<int>(wire::FrameKind::board_identity)),
      nb::make_tuple("board_command", static_cast<int>(wire::FrameKind::board_command)),
      nb::make_tuple("board_reading", static_cast<int>(wire::FrameKind::board_reading)));
  m.attr("max_content") = static_cast<int>(wire::max_content);
  m.attr("board_version") = static_cast<int>(wire::board_version);
  m.def(
      "encode",
      [](std::uint8_t kind, const nb::bytes& content) -> std::optional<nb::bytes> {
        std::array<std::uint8_t, wire::max_frame> bytes{};
        const std::size_t size =
            wire::encode_frame(static_cast<wire::FrameKind>(kind), span_of(content), bytes);
        if (size == 0) return std::nullopt;
        return nb::bytes(bytes.data(), size);
      },
      nb::arg("kind"), nb::arg("content"), "A frame with its final zero; None: too long.");
  nb::class_<wire::FrameDecoder>(m, "Decoder", "Finds frames in the bytes of a serial line.")
      .def(nb::init<>())
      .def(
          "take",
          [](wire::FrameDecoder& self, const nb::bytes& bytes) {
            std::vector<std::tuple<int, nb::bytes>> found;
            for (const std::uint8_t byte : span_of(bytes)) {
              if (!self.take(byte)) continue;
              const wire::Frame frame = self.frame();
              found.emplace_back(frame.kind, bytes_of(frame.content));
            }
            return found;
          },
          nb::arg("bytes"), "The frames that these bytes complete: kind and content.")
      .def_prop_ro("frames", &wire::FrameDecoder::frames, "Frames so far.")
      .def_prop_ro("damaged", &wire::FrameDecoder::damaged,
                   "Byte sequences between two zeros that were no frame.");
  bind_contents(m);
}

}  // namespace palmbots::bindings
