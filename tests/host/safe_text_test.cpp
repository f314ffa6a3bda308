// What names and remarks of files do to a terminal and to the files that are written: nothing.
#include "host/io/coefficient_file.hpp"
#include "host/io/coefficient_metadata.hpp"
#include "host/io/shown.hpp"
#include "host/number.hpp"
#include "tests/support/fields.hpp"
#include "tests/support/run_program.hpp"

#include <catch2/catch.hpp>

#include <nlohmann/json.hpp>

#include <filesystem>

using namespace cowgpu;
using namespace cowgpu::test;
using Catch::Contains;
using Catch::StartsWith;

namespace {

const std::string corpus_folder = std::string(COWGPU_CORPUS) + "/coefficients/";
const std::string attack = "\x1b]0;PWNED\x07\x1b[31mRED\r\nX\xc2\x9b"
                           "31m\x7f \xff \xe2\x80\xae \xed\xa0\x80";

// Neither C0 but line feeds and tabs, nor DEL, nor C1, nor bytes that are no UTF-8, nor marks of direction.
bool safe_for_terminals(const std::string& text) {
  return terminal_text(text) == text && text.find('\x1b') == std::string::npos &&
         text.find('\r') == std::string::npos && text.find("\xc2\x9b") == std::string::npos &&
         text.find('\x7f') == std::string::npos;
}

} // namespace

TEST_CASE("text for one line keeps what is written and loses what a terminal obeys", "[safe-text]") {
  CHECK(one_line("plain 100 % ~") == "plain 100 % ~");
  CHECK(one_line("K\xc3\xbchlschrank \xe2\x82\xac \xf0\x9f\x90\x84") ==
        "K\xc3\xbchlschrank \xe2\x82\xac \xf0\x9f\x90\x84");
  CHECK(one_line("a\r\nb\tc") == "a  b c");
  CHECK(one_line(attack) == " ]0;PWNED  [31mRED  X 31m  ? ? ???");
  CHECK(one_line(std::string("a\0b", 3)) == "a b");
  CHECK(one_line("\xc3") == "?");                     // cut off
  CHECK(one_line("\xc0\x9b\xe0\x82\x9b") == "?????"); // C1 in more bytes than it takes
  CHECK(one_line("\xf4\x90\x80\x80") == "????");      // beyond Unicode
  CHECK(terminal_text("a\n\tb\r\n\x1b[1m") == "a\n\tb \n [1m");
}

TEST_CASE("JSON for a terminal reads back as the same document", "[safe-text]") {
  const nlohmann::json document = {{"name", "\x1b[31m\x7f\xc2\x9b\xe2\x80\xae\xc3\xbc"}};
  const std::string text = terminal_json(document.dump());
  CHECK(safe_for_terminals(text));
  CHECK_THAT(text, Contains("\\u009b") && Contains("\\u007f") && Contains("\\u202e") && Contains("\xc3\xbc"));
  CHECK(nlohmann::json::parse(text) == document);
}

TEST_CASE("a number is all of its word, decimal and finite", "[safe-text]") {
  CHECK(read_number("-1.5e-3") == -1.5e-3);
  CHECK(read_number("+2") == 2);
  CHECK(read_number(".5") == 0.5);
  for (const char* word :
       {"", "nan", "inf", "-inf", "NAN", "0x10", "1,5", "1.5x", " 1", "1 ", "1e999", "abc", "--1", "+-1"})
    CHECK_FALSE(read_number(word));
}

TEST_CASE("what a file says of itself reaches no terminal with its escapes and line ends", "[safe-text][cli]") {
  for (const std::vector<std::string>& arguments : std::vector<std::vector<std::string>>{
           {"reconstruct", corpus_folder + "adv--escape.json", "--order", "0..2", "--device", "cpu"},
           {"reconstruct", corpus_folder + "adv--escape.json", "--order", "0", "--device", "cpu", "--json"},
           {"diff", corpus_folder + "adv--escape-mass.json", corpus_folder + "adv--escape-mass.json"},
           {"diff", corpus_folder + "adv--escape-mass.json", corpus_folder + "adv--escape-mass.json", "--json"},
           {"tensors", corpus_folder + "adv--escape-mass.json"},
           {"tensors", corpus_folder + "adv--escape-mass.json", "--json"},
           {"spectrum", corpus_folder + "adv--escape-mass.json"}}) {
    const ProgramRun run = run_program(arguments);
    INFO(arguments[0] << "\n" << run.out << run.err);
    CHECK(run.exit_code == 0);
    CHECK(safe_for_terminals(run.out));
    CHECK(safe_for_terminals(run.err));
    CHECK_THAT(run.out, !Contains("\nX"));
  }
}

TEST_CASE("names and remarks enter the headers of files as one line without escapes", "[safe-text][cli]") {
  const TemporaryFolder folder;
  for (const char* output : {"m.gfc", "m.sh", "m.csv", "m.json", "m.nc"}) {
    const ProgramRun run = run_program({"convert", corpus_folder + "adv--escape-mass.json", folder / output, "-q"});
    INFO(output << run.err);
    REQUIRE(run.exit_code == 0);
    const CoefficientSet set = read_coefficient_set(folder / output);
    CHECK_THAT(set.provenance.mesh, Contains("]0;PWNED  [31mRED  X 31m"));
    const std::string text = read_text(folder / output);
    if (std::string(output) != "m.nc") CHECK(safe_for_terminals(text));
    CHECK_THAT(text, !Contains("\x1b[31m"));
  }
  const ProgramRun run = run_program({"reconstruct", corpus_folder + "adv--escape.json", "--order", "1", "--device",
                                      "cpu", "-q", "-o", folder / "o.ply"});
  REQUIRE(run.exit_code == 0);
  const std::string ply = read_text(folder / "o.ply");
  CHECK(safe_for_terminals(ply.substr(0, ply.find("end_header"))));
}

TEST_CASE("file names with escapes and bytes that are no UTF-8 are opened, and shown without them",
          "[safe-text][cli]") {
  const TemporaryFolder folder;
  const std::string odd = folder / "a\x1b[31m\xff\xc2\x9b.off";
  REQUIRE(run_program({"inspect", "builtin:box", "-o", folder / "box.off"}).exit_code == 0);
  std::filesystem::copy_file(folder / "box.off", odd);
  for (const std::vector<std::string>& arguments : std::vector<std::vector<std::string>>{
           {"inspect", odd},
           {"inspect", odd, "--json"},
           {"expand", odd, "--lmax", "2", "--device", "cpu", "-o", folder / "o\x1b[1m.csv"},
           {"inspect", odd + "x"},
           {"expand", odd, "--lmax", "\x1b[31m"},
           {"\x1b[31m"}}) {
    const ProgramRun run = run_program(arguments);
    INFO(run.out << run.err);
    CHECK(safe_for_terminals(run.out));
    CHECK(safe_for_terminals(run.err));
    CHECK(run.exit_code == (arguments.back() == odd + "x" ? 5 : arguments.back().find("\x1b[31m") == 0 ? 2 : 0));
  }
  CHECK(safe_for_terminals(read_text(folder / "o\x1b[1m.csv")));
  const ProgramRun two_lines = run_program({"inspect", folder / "a\ncowgpu: wrote b"});
  CHECK(two_lines.exit_code == 2);
  CHECK_THAT(two_lines.err, Contains("line end") && !Contains("\ncowgpu: wrote"));
}

TEST_CASE("a remark that is no number is named, with exit code 3", "[safe-text][cli]") {
  const TemporaryFolder folder;
  const std::string good = read_text(corpus_folder + "adv--mean.csv");
  for (const char* value : {"abc", "nan", "inf", "0x10", "1,5", "1e999"}) {
    write_text(folder / "m.csv", replaced(good, "f_dtheta abc", std::string("f_dtheta ") + value));
    const ProgramRun run =
        run_program({"tip", folder / "m.csv", "--of", "stretch", "--order", "0..2", "--device", "cpu"});
    INFO(value << "\n" << run.err);
    CHECK(run.exit_code == 3);
    CHECK_THAT(run.err, Contains("[file-syntax]") && Contains("removed_mean_f_dtheta") && Contains("finite number"));
  }
}
