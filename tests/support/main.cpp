// The tests' main function. With Catch2's own arguments it is Catch2's; ctest uses three more:
//   --list [--alone]  prints the cases as commands of a ctest script
//   --together [TAG]  runs the quick cases (those with a tag), all in this process with one Vulkan device, and leaves a
//                     record of each to the ctest that called
//   NAME --case       one case: its record where this ctest has one, else it is run. Exit code 0 passed, 1 failed, 77 skipped
// A case is skipped where it prints SKIPPED and nothing in it fails. Tags: [long] takes more than about two seconds of processor
// time, [deep] more than about a minute, [alone] needs a process of its own.
#define CATCH_CONFIG_RUNNER
#include <catch2/catch.hpp>

#include <fmt/format.h>

#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <optional>
#include <sstream>
#include <string>
#include <system_error>
#include <string_view>
#include <vector>

namespace cowgpu::test {
// Of compare_moments.hpp, where the executable has it: tests of readers know no device.
[[gnu::weak]] void share_device(bool share);
} // namespace cowgpu::test

namespace {

namespace fs = std::filesystem;

constexpr int skipped_code = 77; // SKIP_RETURN_CODE of the commands that --list prints

// Passes on what is printed while it lives, and keeps it.
class Listener : public std::streambuf {
public:
  Listener() : before_(std::cout.rdbuf(this)) {}
  ~Listener() override { std::cout.rdbuf(before_); }
  const std::string& text() const { return text_; }

private:
  int_type overflow(int_type c) override {
    if (traits_type::eq_int_type(c, traits_type::eof())) return traits_type::not_eof(c);
    text_ += char(c);
    return before_->sputc(char(c));
  }
  std::streamsize xsputn(const char* text, std::streamsize size) override {
    text_.append(text, std::size_t(size));
    return before_->sputn(text, size);
  }
  int sync() override { return before_->pubsync(); }

  std::streambuf* before_;
  std::string text_;
};

struct Outcome {
  int code = 1;
  std::string text;
  double seconds = 0; // of processor time, children's too: what else the machine does changes it little
};

double processor_seconds() {
  double sum = 0;
  for (const int who : {RUSAGE_SELF, RUSAGE_CHILDREN}) {
    rusage usage{};
    getrusage(who, &usage);
    for (const timeval& t : {usage.ru_utime, usage.ru_stime}) sum += double(t.tv_sec) + 1e-6 * double(t.tv_usec);
  }
  return sum;
}

// Catch2 takes these for its own in the name of a case.
std::string escaped(const std::string& name) {
  std::string out;
  for (const char c : name) out += c == ',' || c == '[' || c == ']' ? std::string("\\") + c : std::string(1, c);
  return out;
}

std::string unescaped(const std::string& text) {
  std::string out;
  for (std::size_t i = 0; i < text.size(); ++i)
    if (text[i] != '\\' || i + 1 == text.size())
      out += text[i];
    else
      out += text[++i];
  return out;
}

Catch::Config& configure(Catch::Session& session, std::vector<std::string> specs) {
  Catch::ConfigData data;
  data.testsOrTags = std::move(specs);
  data.warnings = Catch::WarnAbout::NoTests; // a name that matches nothing fails
  session.useConfigData(data);
  return session.config();
}

Outcome run_case(Catch::Session& session, const std::string& name) {
  configure(session, {escaped(name)});
  Outcome outcome;
  const double start = processor_seconds();
  const Listener listener;
  const bool failed = session.run() != 0;
  std::cout.flush();
  outcome.text = listener.text();
  outcome.seconds = processor_seconds() - start;
  outcome.code = failed ? 1 : outcome.text.find("SKIPPED:") != std::string::npos ? skipped_code : 0;
  return outcome;
}

bool has_tag(const Catch::TestCase& test, std::string_view tag) {
  return std::find(test.lcaseTags.begin(), test.lcaseTags.end(), tag) != test.lcaseTags.end();
}

bool is_quick(const Catch::TestCase& test) {
  return !test.isHidden() && !has_tag(test, "long") && !has_tag(test, "deep") && !has_tag(test, "alone");
}

const std::vector<Catch::TestCase>& all_cases(Catch::Session& session) {
  return Catch::getAllTestCasesSorted(configure(session, {}));
}

// Where records lie: of the process that called, told from later ones with its number by when it began.
fs::path records() {
  const fs::path self = fs::read_symlink("/proc/self/exe");
  const std::string parent = std::to_string(getppid());
  std::ifstream file("/proc/" + parent + "/stat");
  std::string line, field;
  std::getline(file, line);
  std::istringstream fields(line.substr(line.rfind(')') + 1));
  for (int i = 3; i <= 22; ++i) fields >> field; // proc(5): the 22nd is the start time
  return self.parent_path() / "records" / (self.filename().string() + "." + parent + "." + field);
}

fs::path record_of(const fs::path& folder, const std::string& name) {
  return folder / fmt::format("{:016x}", std::hash<std::string>()(name));
}

void write_record(const fs::path& folder, const std::string& name, const Outcome& outcome) {
  const fs::path file = record_of(folder, name), part = file.string() + ".part";
  std::ofstream(part) << outcome.code << '\n' << name << '\n' << outcome.text;
  fs::rename(part, file);
}

// A record tells once: who asks again wants the case run.
std::optional<Outcome> take_record(const std::string& name) {
  const fs::path file = record_of(records(), name);
  std::ifstream in(file);
  Outcome outcome;
  std::string code, whose;
  if (!std::getline(in, code) || !std::getline(in, whose) || whose != name) return std::nullopt;
  outcome.code = code == "0" ? 0 : code == std::to_string(skipped_code) ? skipped_code : 1;
  outcome.text.assign(std::istreambuf_iterator<char>(in), {});
  fs::remove(file);
  return outcome;
}

// Records of processes that have gone. Programs that start together remove the same ones, so that what is not there any more
// is no error.
void remove_old_records(const fs::path& all) {
  std::error_code ignored;
  for (fs::directory_iterator entry(all, ignored), end; !ignored && entry != end; entry.increment(ignored)) {
    const std::string parent = entry->path().stem().extension().string(); // ".123" of mesh_tests.123.456
    std::error_code gone;
    if (parent.size() > 1 && !fs::exists("/proc/" + parent.substr(1))) fs::remove_all(entry->path(), gone);
  }
}

int run_together(Catch::Session& session, const std::string& tag) {
  const fs::path folder = records();
  fs::create_directories(folder);
  remove_old_records(folder.parent_path());
  if (cowgpu::test::share_device) cowgpu::test::share_device(true);
  std::vector<std::string> names;
  for (const Catch::TestCase& test : all_cases(session))
    if (tag.empty() ? is_quick(test) : has_tag(test, tag)) names.push_back(test.name);
  for (const std::string& name : names) {
    const Outcome outcome = run_case(session, name);
    write_record(folder, name, outcome);
    fmt::print("{:8.3f} s  {}  {}\n", outcome.seconds,
               outcome.code == 0              ? "passed "
               : outcome.code == skipped_code ? "skipped"
                                              : "FAILED ",
               name);
    std::fflush(stdout);
  }
  if (cowgpu::test::share_device) cowgpu::test::share_device(false);
  return 0; // what failed says so under its own name
}

int run_one(Catch::Session& session, const std::string& name) {
  if (const auto record = take_record(name)) {
    std::cout << record->text << std::flush;
    return record->code;
  }
  return run_case(session, name).code;
}

// In ctest's order, which is by cost where nothing depends on anything: what runs together, cases alone, long cases.
int list(Catch::Session& session, bool all_alone) {
  const std::string program = fs::read_symlink("/proc/self/exe").string();
  std::string area = fs::path(program).filename().string();
  area = area.substr(0, area.find("_tests"));
  const std::string together = area + ": the quick cases, in one process";
  std::string script;
  bool any = false;
  for (const Catch::TestCase& test : all_cases(session)) {
    if (test.isHidden()) continue;
    const bool is_deep = has_tag(test, "deep"), is_long = is_deep || has_tag(test, "long"),
               alone = all_alone || has_tag(test, "alone");
    any = any || (!is_long && !alone);
    script += fmt::format("add_test([==[{0}]==] [==[{1}]==] [==[{2}]==] --case)\n"
                          "set_tests_properties([==[{0}]==] PROPERTIES SKIP_RETURN_CODE {3} TIMEOUT 900",
                          test.name, program, escaped(test.name), skipped_code);
    if (is_long)
      script += fmt::format(" LABELS {} COST 1)\n", is_deep ? "deep" : "long");
    else
      script += alone ? " COST 50)\n" : fmt::format(" COST 90 DEPENDS [==[{}]==])\n", together);
  }
  if (any)
    script += fmt::format("add_test([==[{0}]==] [==[{1}]==] --together)\n"
                          "set_tests_properties([==[{0}]==] PROPERTIES COST 100 TIMEOUT 900)\n",
                          together, program);
  std::cout << script;
  return 0;
}

} // namespace

int main(int argc, char** argv) {
  Catch::Session session;
  const std::vector<std::string> arguments(argv + 1, argv + argc);
  if (!arguments.empty() && arguments[0] == "--together")
    return run_together(session, arguments.size() > 1 ? arguments[1] : "");
  if (arguments.size() == 2 && arguments[1] == "--case") return run_one(session, unescaped(arguments[0]));
  if (!arguments.empty() && arguments[0] == "--list") return list(session, arguments.size() > 1);
  return session.run(argc, argv);
}
