// The command line: commands, their options and what is asked of a value. CLI11 does the work behind it; numbers in every
// option follow the rule of host/number.hpp.
#pragma once

#include <functional>
#include <initializer_list>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace CLI {
class App;
class Option;
class Validator;
} // namespace CLI

namespace cowgpu::cli {

/// What is asked of an option's value.
class ValueCheck {
public:
  /// `complaint`: why a text is not taken, or an empty text.
  explicit ValueCheck(const std::function<std::string(const std::string&)>& complaint);
  explicit ValueCheck(std::shared_ptr<const CLI::Validator> validator) : validator_(std::move(validator)) {}

private:
  friend class Option;
  std::shared_ptr<const CLI::Validator> validator_;
};

/// A number from `least` to `largest`. Number: int, unsigned, std::size_t, double.
template <class Number>
ValueCheck in_range(Number least, Number largest);
/// A finite number above 0, or one from 0 on.
ValueCheck positive_number();
ValueCheck non_negative_number();
/// A text that is not empty: what a shell's variable that is not set would give.
ValueCheck not_empty();
/// One of these words, which the help shows.
ValueCheck one_of(const std::vector<std::string>& words);
ValueCheck one_of(std::initializer_list<const char*> words);

/// What an option of the type Number cannot take as its value, and why: "'0x10' is hexadecimal; numbers are decimal".
template <class Number>
std::string number_complaint(const std::string& text);

/// An option or flag of a command, which owns it. What sets something returns the option again.
class Option {
public:
  Option* check(const ValueCheck& check);
  /// The same of a function that says why a text is not taken, or nothing.
  Option* check(const std::function<std::string(const std::string&)>& complaint) {
    return check(ValueCheck(complaint));
  }
  /// The word for the value in the help.
  Option* type_name(const std::string& name);
  Option* description(const std::string& text);
  /// The help shows the value that the variable has now.
  Option* capture_default_str();
  Option* required();
  /// Whether a list takes several words after one option (it does) or one each time.
  Option* allow_extra_args(bool allow);
  /// What separates the values of a list within a word.
  Option* delimiter(char separator);
  /// Not both may be given.
  Option* excludes(Option* other);

  /// How often it was given, once the command line is parsed.
  std::size_t count() const;
  std::string get_name() const;
  std::string get_description() const;

private:
  friend class Command;
  explicit Option(CLI::Option* option) : option_(option) {}
  CLI::Option* option_;
};

/// A command with its options and the commands below it, all of which it owns.
class Command {
public:
  ~Command();
  Command(const Command&) = delete;
  Command& operator=(const Command&) = delete;

  /// `name`: "--long", "-s,--long", or a bare word for an argument by its place. `value` keeps what is typed, must live until
  /// the command line is parsed, and its content is the default. Value: std::string, int, unsigned, std::size_t, double,
  /// std::optional<double>, and vectors of std::string and int.
  template <class Value>
  Option* add_option(const std::string& name, Value& value, const std::string& description);
  Option* add_flag(const std::string& name, bool& given, const std::string& description);
  /// One that was added, by name. Throws CLI::OptionNotFound.
  Option* get_option(const std::string& name);

  Command* add_subcommand(const std::string& name, const std::string& description);
  /// So many of the commands below it must be given.
  void require_subcommand(int count);
  /// Whether one of them was, once the command line is parsed.
  bool subcommand_given() const;
  /// The text below the options in the help.
  void footer(const std::string& text);
  /// Called when the whole command line is parsed, if the command was given.
  void callback(const std::function<void()>& call);

  /// For what walks through all options: the man page.
  const CLI::App& app() const { return *app_; }

protected:
  explicit Command(CLI::App* app);
  CLI::App* app_;

private:
  std::vector<std::unique_ptr<Option>> options_;
  std::vector<std::unique_ptr<Command>> commands_;
};

/// What came of a command line.
struct Parsed {
  bool help = false;     ///< help or version was asked for, and is printed
  std::string complaint; ///< why it means nothing, and where to look; empty where it means something
};

/// The command line of a program.
class CommandLine : public Command {
public:
  /// `name`: the program's in complaints.
  CommandLine(const std::string& name, const std::string& description);
  ~CommandLine();

  /// Adds --version, which prints `text`.
  void set_version(const std::string& text);
  /// The names of the commands.
  std::vector<std::string> command_names() const;
  /// Fills the variables and calls the callbacks of the commands given. Throws what they throw.
  Parsed parse(int argc, char** argv);

private:
  std::string name_;
  std::unique_ptr<CLI::App> root_;
};

} // namespace cowgpu::cli
