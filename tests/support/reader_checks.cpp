#include "tests/support/reader_checks.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <malloc.h>
#include <random>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

namespace cowgpu::test {

Outcome outcome_of(const std::function<void()>& work) {
  try {
    work();
  } catch (const Error& error) {
    return {std::string(name(error.fault())), error.what()};
  }
  return {};
}

void check_prefixes(const std::string& bytes, const Reader& read) {
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    // A copy of just that size lets the address sanitizer see reads beyond its end.
    const std::vector<char> prefix(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size));
    try {
      outcome_of([&] { read({prefix.data(), prefix.size()}); });
    } catch (const std::exception& error) {
      FAIL_CHECK("the first " << size << " bytes: " << error.what());
    }
  }
}

void check_mutations(const std::string& bytes, int rounds, const Reader& read) {
  std::mt19937 random(1);
  const std::string likely = std::string("0123456789 -+.eE#/\\\n\r\t{}[],:\"vfOPSN") + '\0' + "\x01\x7f\x80\xff";
  for (int round = 0; round < rounds; ++round) {
    std::string bad = bytes;
    for (std::size_t i = random() % 4 + 1; i != 0 && !bad.empty(); --i) {
      const std::size_t at = random() % bad.size();
      switch (random() % 6) {
      case 0: bad.erase(at, random() % 8); break;
      case 1: bad.insert(at, bad.substr(random() % bad.size(), random() % 16)); break;
      case 2: bad[at] = static_cast<char>(random()); break;
      case 3: bad.replace(at, std::min<std::size_t>(4, bad.size() - at), "\xff\xff\xff\x7f"); break;
      default: bad[at] = likely[random() % likely.size()]; break;
      }
    }
    const std::vector<char> copy(bad.begin(), bad.end());
    try {
      outcome_of([&] { read({copy.data(), copy.size()}); });
    } catch (const std::exception& error) {
      FAIL_CHECK("round " << round << ": " << error.what() << " of " << bad);
    }
  }
}

std::string replaced(std::string text, const std::string& what, const std::string& by) {
  const std::size_t at = text.find(what);
  INFO(what);
  REQUIRE(at != std::string::npos);
  return text.replace(at, what.size(), by);
}

std::size_t peak_growth(const std::function<void()>& work) {
  const auto peak = [] {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return static_cast<std::size_t>(usage.ru_maxrss) * 1024;
  };
  malloc_trim(0); // so that nothing that was freed is used again unseen
  int ends[2];
  REQUIRE(pipe(ends) == 0);
  const pid_t child = fork();
  REQUIRE(child >= 0);
  if (child == 0) {
    const std::size_t before = peak();
    work();
    const std::size_t growth = peak() - before;
    _exit(write(ends[1], &growth, sizeof growth) == sizeof growth ? 0 : 1);
  }
  close(ends[1]);
  std::size_t growth = 0;
  const bool told = read(ends[0], &growth, sizeof growth) == sizeof growth;
  close(ends[0]);
  int status = 0;
  waitpid(child, &status, 0);
  REQUIRE(told);
  return growth;
}

// What GCC defines clang answers as a question.
#if defined(__has_feature)
#if __has_feature(address_sanitizer)
#define COWGPU_CLANG_SANITIZES 1
#endif
#endif

bool memory_is_measurable() {
#if defined(__SANITIZE_ADDRESS__) || defined(COWGPU_CLANG_SANITIZES)
  return false;
#else
  return true;
#endif
}

std::vector<std::filesystem::path> corpus(const std::string& folder) {
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(std::filesystem::path(COWGPU_CORPUS) / folder))
    files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  return files;
}

} // namespace cowgpu::test
