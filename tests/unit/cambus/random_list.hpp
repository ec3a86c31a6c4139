#pragma once

#include <cstddef>
#include <cstdint>
#include <random>
#include <vector>

#include "drivers/cambus/step_list_builder.hpp"

namespace thimble::cambus::test {

// What a list was asked to send, in order.
struct SentWords {
  Register to{};
  std::vector<std::uint16_t> words;
  bool operator==(const SentWords&) const = default;
};

// A step list as a program could build it, and what it is to send.
struct RandomList {
  StepList list;
  std::vector<SentWords> sent;
  std::uint32_t steps{0};
};

inline std::uint32_t code_of(const Field& of, std::mt19937& random) {
  std::uint32_t value = 0;
  do {
    value = static_cast<std::uint32_t>(random()) & ((1U << of.bits) - 1U);
  } while (!means_something(of.codes, value));
  return value;
}

inline RegisterWords random_words(Register number, std::mt19937& random) {
  RegisterWords words(number);
  const bool is_uniform = random() % 2 == 0;
  for (const Field& of : facts_of(number).fields) {
    if (is_uniform) words.set(of, code_of(of, random));
    for (int layer = 0; layer < kLayers && !is_uniform; ++layer) {
      words.set(of, code_of(of, random), static_cast<LayerMask>(1U << layer));
    }
  }
  if (number == Register::Run) words.set(field::kSync, kSyncFree);
  return words;
}

inline std::vector<std::uint16_t> port_words(std::mt19937& random) {
  std::vector<std::uint16_t> words(1 + random() % 40);
  for (auto& word : words) word = static_cast<std::uint16_t>(random());
  return words;
}

inline RandomList random_list(std::mt19937& random, std::uint32_t base = wire::kReservedBytes) {
  RandomList made;
  StepListBuilder builder(base);
  const std::size_t steps = 1 + random() % 20;
  for (std::size_t i = 0; i < steps; ++i, ++made.steps) {
    const auto number = static_cast<Register>(random() % kRegisterCount);
    const bool is_port = facts_of(number).bits == 0;
    if (random() % 8 == 0) {
      builder.delay(1 + static_cast<std::uint32_t>(random() % 1000));
    } else if (random() % 3 == 0) {
      builder.read(number,
                   is_port ? 1 + static_cast<std::uint32_t>(random() % 30) : facts_of(number).bits);
    } else if (is_port) {
      made.sent.push_back({number, port_words(random)});
      builder.write_port(number, made.sent.back().words);
      made.steps += number == Register::ScanIo ? 1 : 0;  // its delay
    } else {
      const RegisterWords words = random_words(number, random);
      made.sent.push_back({number, {words.words().begin(), words.words().end()}});
      builder.write(words);
    }
    if (random() % 10 == 0) builder.raise_interrupt();
  }
  made.list = builder.finish();
  return made;
}

}  // namespace thimble::cambus::test
