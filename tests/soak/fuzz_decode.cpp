// SPDX-License-Identifier: Apache-2.0
// Fuzz target of the wire (libFuzzer). The first byte of an input says which law the rest is put to:
//   0  any bytes: `decode` accepts them if and only if they are what somebody with the key can say,
//      and then `encode` gives the same bytes again;
//   1  the same with a right tag put under the first 24 bytes, which no fuzzer would find by itself;
//   2  any packet: `encode` takes it if and only if it can be said, and `decode` gives it back;
//   3  a script of sending, delivering in any order, flipping a bit and booting: what an end accepts
//      was sent by the partner after this end's boot, as it is, once and in the order of sending;
//      and it accepts whatever is newer than all before and was sent by one who knew of that boot;
//   4  any bytes on a serial line: the frames in them are those of tests/cpp/support/frame_laws.hpp,
//      and `encode_frame` gives the same bytes again;
//   5  the same with a right frame between other bytes, which no fuzzer would find by itself.
// What can be said is a rule of tests/cpp/support/wire_packets.hpp, not what the header under test
// says.
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "palmbots/wire/endpoint.hpp"
#include "palmbots/wire/serial_frame.hpp"
#include "support/frame_laws.hpp"
#include "support/wire_packets.hpp"

using namespace palmbots::wire;

namespace {

using Input = std::span<const std::uint8_t>;

#define LAW(expression)                  \
  do {                                   \
    if (!(expression)) __builtin_trap(); \
  } while (false)

// Whether 32 bytes bear the tag of the first 24, byte by byte.
bool tag_is_right(Input bytes) {
  const std::uint64_t tag = palmbots::siphash24(test_key, bytes.first(24));
  for (std::size_t i = 0; i < 8; ++i) {
    if (bytes[24 + i] != (tag >> 8 * i & 0xff)) return false;
  }
  return true;
}

Payload payload_at(Input b, std::size_t first) {
  return {b[first], b[first + 1], b[first + 2], b[first + 3], b[first + 4]};
}

// By the bytes alone, as docs/reference/wire.md numbers them.
bool ought_to_be_accepted(Input b) {
  if (b.size() != 32 || b[0] != 3 || (b[3] | b[4] << 8) != test_pair || !tag_is_right(b)) {
    return false;
  }
  const bool epoch = (b[5] | b[6] | b[7]) != 0;
  const bool sequence = (b[8] | b[9] | b[10] | b[11]) != 0;
  const bool heard_epoch = (b[12] | b[13] | b[14]) != 0;
  const bool heard_sequence = (b[15] | b[16] | b[17] | b[18]) != 0;
  return can_be_said(b[1], b[2] & 15, b[2] >> 4, payload_at(b, 19)) && epoch && sequence &&
         heard_epoch == heard_sequence;
}

void any_bytes(Input bytes) {
  for (const Role receiver : {Role::left, Role::right, Role::station}) {
    const Decoded decoded = decode(bytes, test_key, test_pair, receiver);
    const bool accepted = decoded.verdict == Verdict::accepted;
    const bool for_it = bytes.size() > 2 && bytes[2] >> 4 == static_cast<int>(receiver);
    LAW(accepted == (for_it && ought_to_be_accepted(bytes)));
    if (!accepted) {
      LAW(decoded.packet == Packet{});
      continue;
    }
    Bytes again{};
    LAW(encode(decoded.packet, test_key, again));
    LAW(std::equal(again.begin(), again.end(), bytes.begin(), bytes.end()));
  }
}

void any_tagged_bytes(Input bytes) {
  if (bytes.size() < 24) return;
  Bytes tagged{};
  std::copy_n(bytes.begin(), 24, tagged.begin());
  const std::uint64_t tag = palmbots::siphash24(test_key, bytes.first(24));
  for (std::size_t i = 0; i < 8; ++i) tagged[24 + i] = static_cast<std::uint8_t>(tag >> 8 * i);
  any_bytes(tagged);
}

void any_packet(Input b) {
  if (b.size() < 25) return;
  const auto word = [&](std::size_t at) {
    return static_cast<std::uint32_t>(palmbots::little_endian(b.subspan(at, 4)));
  };
  const Packet packet{static_cast<PacketKind>(b[0]),
                      static_cast<Role>(b[1] & 15),
                      static_cast<Role>(b[1] >> 4),
                      static_cast<std::uint16_t>(b[2] | b[3] << 8),
                      {word(4), word(8)},
                      {word(12), word(16)},
                      payload_at(b, 20)};
  const bool sane = can_be_said(b[0], b[1] & 15, b[1] >> 4, packet.payload) &&
                    packet.sent.epoch > 0 && packet.sent.epoch < 1 << 24 &&
                    packet.sent.sequence > 0 && packet.heard.epoch < 1 << 24 &&
                    (packet.heard.epoch > 0) == (packet.heard.sequence > 0);
  Bytes bytes{};
  LAW(encode(packet, test_key, bytes) == sane);
  if (!sane) {
    LAW(bytes == Bytes{});
    return;
  }
  const Decoded decoded = decode(bytes, test_key, packet.pair, packet.receiver);
  LAW(decoded.verdict == Verdict::accepted && decoded.packet == packet);
}

void script(Input steps) {
  constexpr std::size_t never = ~std::size_t{0};
  struct Sent {
    Bytes bytes;
    std::size_t at;     // step of sending
    std::size_t life;   // step of the sender's boot
    std::size_t heard;  // step of the receiver's boot that the sender knew of, or never
  };
  // What an end ought to know, in steps of the script instead of epochs and numbers.
  struct Memory {
    std::size_t booted = 0;
    std::size_t newest = 0;     // when the newest packet taken was sent, in this life
    std::size_t heard = never;  // the partner's boot according to that packet
    std::size_t accepted = 0;   // when the newest packet ever accepted was sent
    std::uint32_t epoch = 1;
  };
  constexpr Role role[2] = {Role::left, Role::right};
  const auto boot = [&](std::size_t end, std::uint32_t epoch) {
    return Endpoint({test_key, test_pair, role[end]}, epoch);
  };
  Endpoint ends[2] = {boot(0, 1), boot(1, 1)};
  Memory memories[2];
  std::vector<Sent> sent[2];  // by sender
  for (std::size_t now = 1; now < steps.size(); ++now) {
    const std::uint8_t step = steps[now - 1];
    const std::size_t end = step & 1;
    Memory& memory = memories[end];
    const std::vector<Sent>& coming = sent[1 - end];
    if ((step & 6) == 0) {
      memory = {now, 0, never, memory.accepted, memory.epoch + 1};
      ends[end] = boot(end, memory.epoch);
    } else if ((step & 6) == 2) {
      Bytes bytes{};
      LAW(ends[end].send(role[1 - end], PacketKind::state, request, bytes));
      sent[end].push_back({bytes, now, memory.booted, memory.heard});
    } else if (!coming.empty()) {
      Sent packet = coming[coming.size() - 1 - (step >> 3) % coming.size()];
      const bool flipped = (step & 6) == 6;
      if (flipped) packet.bytes[steps[now] % 32] ^= static_cast<std::uint8_t>(1 << steps[now] / 32);
      const bool taken = !flipped && packet.at > memory.newest;
      if (taken) {
        memory.newest = packet.at;
        memory.heard = packet.life;
      }
      const bool accepted = ends[end].receive(packet.bytes).verdict == Verdict::accepted;
      LAW(accepted == (taken && packet.heard == memory.booted));
      if (!accepted) continue;
      LAW(packet.at > memory.booted && packet.at > memory.accepted);
      memory.accepted = packet.at;
    }
  }
}

void any_line(Input stream) {
  const frame_laws::Found found = frame_laws::frames_in(stream);
  FrameDecoder decoder;
  std::size_t frames = 0;
  std::vector<std::uint8_t> piece;  // since the last zero
  for (const std::uint8_t byte : stream) {
    piece.push_back(byte);
    if (decoder.take(byte)) {
      const Frame frame = decoder.frame();
      LAW(frames < found.frames.size());
      const std::vector<std::uint8_t>& right = found.frames[frames++];
      LAW(frame.kind == right[0]);
      LAW(std::equal(frame.content.begin(), frame.content.end(), right.begin() + 1, right.end()));
      std::array<std::uint8_t, max_frame> again{};
      const std::size_t size =
          encode_frame(static_cast<FrameKind>(frame.kind), Input(right).subspan(1), again);
      LAW(std::equal(piece.begin(), piece.end(), again.begin(),
                     again.begin() + static_cast<std::ptrdiff_t>(size)));
    }
    if (byte == 0) piece.clear();
  }
  LAW(frames == found.frames.size() && decoder.frames() == frames);
  LAW(decoder.damaged() == found.damaged);
}

// The first two bytes are how much of the input is before the frame, and how much in it.
void any_framed_line(Input input) {
  if (input.size() < 2) return;
  const Input rest = input.subspan(2);
  const Input before = rest.first(std::min<std::size_t>(rest.size(), input[0] % 80));
  const Input after = rest.subspan(before.size());
  const Input content = after.first(std::min<std::size_t>(after.size(), input[1] % 65));
  std::array<std::uint8_t, max_frame> bytes{};
  const std::size_t size = encode_frame(FrameKind::packet, content, bytes);
  std::vector<std::uint8_t> stream(before.begin(), before.end());
  stream.push_back(0);
  stream.insert(stream.end(), bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size));
  const frame_laws::Found found = frame_laws::frames_in(stream);
  LAW(!found.frames.empty() && found.frames.back().size() == content.size() + 1);
  any_line(stream);
  for (const std::uint8_t byte : after.subspan(content.size())) {  // places of flipped bits
    stream[byte % stream.size()] ^= static_cast<std::uint8_t>(1 << byte % 8);
  }
  any_line(stream);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const Input rest(data + 1, size - 1);
  switch (data[0]) {
    case 0: any_bytes(rest); break;
    case 1: any_tagged_bytes(rest); break;
    case 2: any_packet(rest); break;
    case 3: script(rest); break;
    case 4: any_line(rest); break;
    case 5: any_framed_line(rest); break;
    default: return -1;  // of no use: not to be kept
  }
  return 0;
}
