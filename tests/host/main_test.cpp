// What tests/support/main.cpp tells ctest of a case, in its own process and among others.
#include <catch2/catch.hpp>

#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>
#include <filesystem>
#include <iostream>
#include <set>
#include <string>

namespace {

struct Told {
  int code = -1;
  std::string text;
};

// This test program as a child of this process.
Told told(const std::string& arguments) {
  const std::string command = "exec '" + std::filesystem::read_symlink("/proc/self/exe").string() + "' " + arguments;
  FILE* const pipe = popen(command.c_str(), "r");
  REQUIRE(pipe);
  Told result;
  for (int c = fgetc(pipe); c != EOF; c = fgetc(pipe)) result.text += char(c);
  const int status = pclose(pipe);
  result.code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  return result;
}

std::string process_in(const std::string& text) {
  const std::size_t at = text.find("process ");
  REQUIRE(at != std::string::npos);
  return text.substr(at, text.find('\n', at) - at);
}

void tell_process() {
  std::cout << "process " << getpid() << std::endl;
}

// Names as ctest gives them, and the codes it must get.
const std::pair<const char*, int> samples[] = {{"'sample: passes'", 0},
                                               {"'sample: is skipped\\, with a comma and \\[brackets\\]'", 77},
                                               {"'sample: fails beside a skip'", 1},
                                               {"'sample: fails'", 1}};

} // namespace

TEST_CASE("sample: passes", "[.][sample]") {
  tell_process();
  CHECK(true);
}

TEST_CASE("sample: is skipped, with a comma and [brackets]", "[.][sample]") {
  tell_process();
  std::cout << "SKIPPED: for the sake of it" << std::endl;
}

TEST_CASE("sample: fails beside a skip", "[.][sample]") {
  tell_process();
  WARN("SKIPPED: a half of it");
  CHECK(getpid() == 0);
}

TEST_CASE("sample: fails", "[.][sample]") {
  tell_process();
  for (int i = 0; i < 77; ++i) CHECK(getpid() == i); // the code is no count
}

TEST_CASE("a case passes, is skipped or fails, and fails beside a skip", "[main]") {
  for (const auto& [name, code] : samples) {
    const Told alone = told(std::string(name) + " --case");
    INFO(alone.text);
    CHECK(alone.code == code);
  }
  CHECK(told("'no such case' --case").code == 1);
}

TEST_CASE("cases that ran together are told one by one and once", "[main]") {
  const Told together = told("--together sample");
  INFO(together.text);
  CHECK(together.code == 0);
  std::set<std::string> at_first, later;
  for (const auto& [name, code] : samples) {
    const Told first = told(std::string(name) + " --case");
    INFO(first.text);
    CHECK(first.code == code);
    at_first.insert(process_in(first.text));
    const Told second = told(std::string(name) + " --case");
    CHECK(second.code == code);
    later.insert(process_in(second.text));
  }
  CHECK(at_first.size() == 1);
  CHECK(later.size() == std::size(samples));
  CHECK(later.count(*at_first.begin()) == 0);
}

TEST_CASE("ctest's list has every case that is not hidden, and the code of a skip", "[main]") {
  const Told list = told("--list");
  CHECK(list.code == 0);
  CHECK(list.text.find("add_test([==[a case passes, is skipped or fails, and fails beside a skip]==]") !=
        std::string::npos);
  CHECK(list.text.find("SKIP_RETURN_CODE 77") != std::string::npos);
  CHECK(list.text.find("sample: fails") == std::string::npos);
  CHECK(list.text.find("the quick cases, in one process") != std::string::npos);
  CHECK(told("--list --alone").text.find("the quick cases, in one process") == std::string::npos);
}
