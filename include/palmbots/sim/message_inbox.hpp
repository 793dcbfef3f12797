// SPDX-License-Identifier: Apache-2.0
// The messages that a robot has received and its controller has not yet read, in order of arrival.
#pragma once

#include <array>
#include <cstdint>

#include "palmbots/control/messages.hpp"

namespace palmbots {

// A queue of messages.
class MessageInbox {
 public:
  // Returns false if the inbox is full; the message is then dropped.
  bool push(MessageKind message) {
    if (tail_ - head_ == capacity) return false;
    messages_[tail_++ % capacity] = message;
    return true;
  }

  // The oldest message, or null.
  const MessageKind* oldest() const {
    return head_ != tail_ ? &messages_[head_ % capacity] : nullptr;
  }

  void pop() { ++head_; }
  void clear() { head_ = tail_; }

 private:
  static constexpr std::uint32_t capacity = 256;  // as many as a link holds

  std::array<MessageKind, capacity>
      messages_;  // not cleared: head_ and tail_ delimit the valid part
  std::uint32_t head_ = 0;
  std::uint32_t tail_ = 0;
};

}  // namespace palmbots
