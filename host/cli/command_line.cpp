#include "host/cli/command_line.hpp"

#include "host/cli/cli11.hpp"
#include "host/io/shown.hpp"
#include "host/number.hpp"

#include <fmt/format.h>

#include <optional>
#include <type_traits>

namespace cowgpu::cli {
namespace {

using Complaint = std::function<std::string(const std::string&)>;

ValueCheck value_check(const Complaint& complaint, const std::string& description) {
  return ValueCheck(std::make_shared<CLI::Validator>(complaint, description));
}

// CLI11's own checks print bounds of 309 digits.
ValueCheck number_check(const char* what, bool (*holds)(double)) {
  return value_check(
      [what, holds](const std::string& text) {
        const auto value = read_number(text);
        if (!value) return fmt::format("{}; it takes {}", number_complaint<double>(text), what);
        return holds(*value) ? std::string() : fmt::format("{} is not {}", shown(text), what);
      },
      "");
}

} // namespace

ValueCheck::ValueCheck(const Complaint& complaint) : validator_(std::make_shared<CLI::Validator>(complaint, "")) {}

template <class Number>
std::string number_complaint(const std::string& text) {
  return fmt::format("'{}' {}", shown(text), std::is_integral_v<Number> ? not_whole(text) : not_a_number(text));
}

template <class Number>
ValueCheck in_range(Number least, Number largest) {
  const auto bounds = fmt::format("from {} to {}", least, largest);
  return value_check(
      [=](const std::string& text) -> std::string {
        Number value{};
        const char* const kind = std::is_integral_v<Number> ? "a whole number" : "a number";
        if (!CLI::detail::lexical_cast(text, value))
          return fmt::format("{}; it takes {} {}", number_complaint<Number>(text), kind, bounds);
        if (!(value >= least && value <= largest)) return fmt::format("{} is not {} {}", shown(text), kind, bounds);
        return {};
      },
      fmt::format("{} in [{} - {}]", CLI::detail::type_name<Number>(), least, largest));
}

template ValueCheck in_range(int, int);
template ValueCheck in_range(unsigned, unsigned);
template ValueCheck in_range(std::size_t, std::size_t);
template ValueCheck in_range(double, double);

ValueCheck positive_number() {
  return number_check("a finite number above 0", [](double value) { return value > 0; });
}

ValueCheck non_negative_number() {
  return number_check("a finite number from 0 on", [](double value) { return value >= 0; });
}

ValueCheck not_empty() {
  return value_check([](const std::string& text) { return std::string(text.empty() ? "the value is empty" : ""); }, "");
}

ValueCheck one_of(const std::vector<std::string>& words) {
  return ValueCheck(std::make_shared<CLI::IsMember>(words));
}

ValueCheck one_of(std::initializer_list<const char*> words) {
  return one_of(std::vector<std::string>(words.begin(), words.end()));
}

Option* Option::check(const ValueCheck& check) {
  option_->check(*check.validator_);
  return this;
}

Option* Option::type_name(const std::string& name) {
  option_->type_name(name);
  return this;
}

Option* Option::description(const std::string& text) {
  option_->description(text);
  return this;
}

Option* Option::capture_default_str() {
  option_->capture_default_str();
  return this;
}

Option* Option::required() {
  option_->required();
  return this;
}

Option* Option::allow_extra_args(bool allow) {
  option_->allow_extra_args(allow);
  return this;
}

Option* Option::delimiter(char separator) {
  option_->delimiter(separator);
  return this;
}

Option* Option::excludes(Option* other) {
  option_->excludes(other->option_);
  return this;
}

std::size_t Option::count() const {
  return option_->count();
}

std::string Option::get_name() const {
  return option_->get_name();
}

std::string Option::get_description() const {
  return option_->get_description();
}

Command::Command(CLI::App* app) : app_(app) {}
Command::~Command() = default;

template <class Value>
Option* Command::add_option(const std::string& name, Value& value, const std::string& description) {
  options_.push_back(std::unique_ptr<Option>(new Option(app_->add_option(name, value, description))));
  return options_.back().get();
}

template Option* Command::add_option(const std::string&, std::string&, const std::string&);
template Option* Command::add_option(const std::string&, int&, const std::string&);
template Option* Command::add_option(const std::string&, unsigned&, const std::string&);
template Option* Command::add_option(const std::string&, std::size_t&, const std::string&);
template Option* Command::add_option(const std::string&, double&, const std::string&);
template Option* Command::add_option(const std::string&, std::optional<double>&, const std::string&);
template Option* Command::add_option(const std::string&, std::vector<std::string>&, const std::string&);
template Option* Command::add_option(const std::string&, std::vector<int>&, const std::string&);

Option* Command::add_flag(const std::string& name, bool& given, const std::string& description) {
  options_.push_back(std::unique_ptr<Option>(new Option(app_->add_flag(name, given, description))));
  return options_.back().get();
}

Option* Command::get_option(const std::string& name) {
  CLI::Option* const found = app_->get_option(name);
  for (const auto& option : options_)
    if (option->option_ == found) return option.get();
  options_.push_back(std::unique_ptr<Option>(new Option(found)));
  return options_.back().get();
}

Command* Command::add_subcommand(const std::string& name, const std::string& description) {
  commands_.push_back(std::unique_ptr<Command>(new Command(app_->add_subcommand(name, description))));
  return commands_.back().get();
}

void Command::require_subcommand(int count) {
  app_->require_subcommand(count);
}

bool Command::subcommand_given() const {
  return !app_->get_subcommands().empty();
}

void Command::footer(const std::string& text) {
  app_->footer(text);
}

void Command::callback(const std::function<void()>& call) {
  app_->callback(call);
}

CommandLine::CommandLine(const std::string& name, const std::string& description)
    : Command(nullptr), name_(name), root_(std::make_unique<CLI::App>(description)) {
  app_ = root_.get();
}

CommandLine::~CommandLine() = default;

void CommandLine::set_version(const std::string& text) {
  root_->set_version_flag("--version", text);
}

std::vector<std::string> CommandLine::command_names() const {
  std::vector<std::string> names;
  for (const CLI::App* command : root_->get_subcommands([](CLI::App*) { return true; }))
    names.push_back(command->get_name());
  return names;
}

Parsed CommandLine::parse(int argc, char** argv) {
  Parsed parsed;
  try {
    root_->parse(argc, argv);
  } catch (const CLI::Success& help) {
    root_->exit(help);
    parsed.help = true;
  } catch (const CLI::ParseError& error) {
    std::string command = name_;
    for (const CLI::App* at = root_.get(); !at->get_subcommands().empty();) {
      at = at->get_subcommands().front();
      command += " " + at->get_name();
    }
    parsed.complaint = fmt::format("{}; see `{} --help`", error.what(), command);
  }
  return parsed;
}

} // namespace cowgpu::cli
