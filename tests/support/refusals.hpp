// Requests that functions refuse in words.
#pragma once

#include "host/error.hpp"

#include <catch2/catch.hpp>

#include <string>

namespace cowgpu::test {

/// The call is refused as a bad argument, and the sentence says `word`.
template <class Call>
void refuses(const Call& call, const std::string& word) {
  INFO("it should say: " << word);
  try {
    call();
    FAIL("it was taken");
  } catch (const Error& error) {
    CHECK(error.fault() == Fault::bad_argument);
    CHECK_THAT(error.what(), Catch::Contains(word));
  }
}

} // namespace cowgpu::test
