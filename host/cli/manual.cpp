// The man page and the shell completion, from the same option table as --help.
#include "host/cli/commands.hpp"

#include "host/cli/cli11.hpp"
#include "host/requests/meshes.hpp"
#include "host/version.hpp"

#include <fmt/format.h>

#include <vector>

namespace cowgpu::cli {
namespace {

// What groff would take for its own.
std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '\\')
      out += "\\e";
    else if (c == '-')
      out += "\\-";
    else if (c == '\n')
      out += "\n.br\n";
    else if ((c == '.' || c == '\'') && (out.empty() || out.back() == '\n'))
      out += std::string("\\&") + c;
    else
      out += c;
  }
  return out;
}

std::vector<const CLI::App*> subcommands(const CLI::App& app) {
  return app.get_subcommands([](const CLI::App* command) { return !command->get_group().empty(); });
}

std::vector<const CLI::Option*> options(const CLI::App& app) {
  std::vector<const CLI::Option*> shown;
  for (const CLI::Option* option : app.get_options())
    if (!option->get_group().empty()) shown.push_back(option);
  return shown;
}

// "{auto,none,jsonl}" of a type name, as words.
std::vector<std::string> words(const CLI::Option& option) {
  const std::string type = option.get_type_name();
  const std::size_t open = type.find('{'), close = type.find('}');
  std::vector<std::string> found;
  if (open == std::string::npos || close == std::string::npos) return found;
  std::string word;
  for (const char c : type.substr(open + 1, close - open - 1) + ",")
    if (c == ',') {
      found.push_back(word);
      word.clear();
    } else if (c != ' ') {
      word += c;
    }
  return found;
}

bool is_flag(const CLI::Option& option) {
  return option.get_items_expected_max() == 0;
}

void write_options(std::string& page, const CLI::App& app) {
  for (const CLI::Option* option : options(app)) {
    std::string name = option->get_name(true, true); // positionals too
    page += ".TP\n.B " + escaped(name);
    if (!is_flag(*option) && !option->get_positional()) page += " \\fI" + escaped(option->get_type_name()) + "\\fR";
    page += "\n" + escaped(option->get_description());
    if (!option->get_default_str().empty()) page += escaped(" [default: " + option->get_default_str() + "]");
    page += "\n";
  }
}

void write_command(std::string& page, const CLI::App& app, const std::string& before) {
  const std::string name = before + " " + app.get_name();
  page += ".SS " + escaped(name) + "\n" + escaped(app.get_description()) + ".\n";
  write_options(page, app);
  for (const CLI::App* command : subcommands(app)) write_command(page, *command, name);
}

std::string joined(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : " ") + word;
  return text;
}

// The lines of one command's case: its options, then what follows each of those that take certain words.
void complete_command(std::string& script, const CLI::App& app, const std::string& path) {
  std::vector<std::string> names;
  std::string values;
  for (const CLI::Option* option : options(app)) {
    std::string own;
    for (const std::string& n : option->get_snames()) {
      names.push_back("-" + n);
      own += (own.empty() ? "-" : "|-") + n;
    }
    for (const std::string& n : option->get_lnames()) {
      names.push_back("--" + n);
      own += (own.empty() ? "--" : "|--") + n;
    }
    if (own.empty() || is_flag(*option)) continue;
    std::vector<std::string> choice = words(*option);
    if (choice.empty() && own == "--device") choice = {"auto", "cpu"};
    values += fmt::format("        {}) words=\"{}\"; taken=1 ;;\n", own, joined(choice));
  }
  for (const CLI::App* command : subcommands(app)) names.push_back(command->get_name());
  script += fmt::format("    '{}')\n      options=\"{}\"\n", path, joined(names));
  if (!values.empty()) script += "      case $previous in\n" + values + "      esac\n";
  script += "      ;;\n";
  for (const CLI::App* command : subcommands(app))
    complete_command(script, *command, path.empty() ? command->get_name() : path + " " + command->get_name());
}

// cowgpu(1) in the macros of groff's man.
std::string man_page(const CLI::App& app) {
  std::string page = fmt::format(".TH COWGPU 1 \"\" \"cowgpu {}\" \"User Commands\"\n", version);
  page += ".SH NAME\ncowgpu \\- multipole moments of triangle meshes, and what follows from them\n";
  page += ".SH SYNOPSIS\n.B cowgpu\n.I COMMAND\n[\\fIARGUMENTS\\fR]\n.SH DESCRIPTION\n";
  page += escaped(app.get_description()) + ".\n.SH OPTIONS\n";
  write_options(page, app);
  page += ".SH COMMANDS\n";
  for (const CLI::App* command : subcommands(app)) write_command(page, *command, "cowgpu");
  page += ".SH NOTES\n" + escaped(app.get_footer()) + "\n";
  page += ".SH ENVIRONMENT\n.TP\n.B COWGPU_MESHES\nA folder in which named meshes are looked for first.\n";
  return page;
}

// Of commands, options, the words that an option takes, built-in bodies and file names.
std::string bash_completion(const CLI::App& app) {
  std::string bodies, paths, cases;
  for (const CatalogueEntry& entry : mesh_catalogue()) bodies += entry.name + " ";
  for (const std::string& usage : builtin_usages())
    bodies += usage.substr(0, usage.find_first_of(":@[", usage.find(':') + 1)) + " ";
  for (const CLI::App* command : subcommands(app)) {
    paths += "|" + command->get_name() + "|";
    for (const CLI::App* below : subcommands(*command))
      paths += "|" + command->get_name() + " " + below->get_name() + "|";
  }
  complete_command(cases, app, "");
  // Words are split at blanks alone: bash also splits at the colon of builtin:cow, and takes replies without what is
  // before it.
  return "# bash completion of cowgpu, written by `cowgpu completion`\n"
         "_cowgpu() {\n"
         "  local line=${COMP_LINE:0:COMP_POINT} all current previous options='' words='' taken='' path='' i\n"
         "  local known='" +
         paths + "' bodies='" + bodies + R"('
  read -ra all <<<"$line"
  [[ $line == *[[:blank:]] ]] && all+=('')
  ((${#all[@]} > 1)) || return 0
  current=${all[-1]} previous=${all[-2]}
  for ((i = 1; i < ${#all[@]} - 1; ++i)); do
    [[ $known == *"|${path:+$path }${all[i]}|"* ]] && path="${path:+$path }${all[i]}"
  done
  case $path in
)" + cases +
         R"(  esac
  COMPREPLY=()
  if [[ $taken && $words ]]; then
    COMPREPLY=($(compgen -W "$words" -- "$current"))
  elif [[ $taken ]]; then
    compopt -o filenames 2>/dev/null
    COMPREPLY=($(compgen -f -- "$current"))
  elif [[ ! $path || $current == -* || $known == *"|$path "* ]]; then
    COMPREPLY=($(compgen -W "$options" -- "$current"))
  else
    COMPREPLY=($(compgen -W "$bodies" -- "$current"))
    if ((${#COMPREPLY[@]} == 0)) || [[ ! $current ]]; then
      compopt -o filenames 2>/dev/null
      COMPREPLY+=($(compgen -f -- "$current"))
    fi
  fi
  if [[ $current == *:* && ${COMP_WORDBREAKS-} == *:* ]]; then
    local before=${current%"${current##*:}"}
    COMPREPLY=("${COMPREPLY[@]#"$before"}")
  fi
}
complete -F _cowgpu cowgpu
)";
}

} // namespace

void add_manual(Command& app) {
  app.add_subcommand("man", "Print the man page, cowgpu(1)")->callback([&app] { write_stdout(man_page(app.app())); });
  app.add_subcommand("completion", "Print the completion for bash: source <(cowgpu completion)")->callback([&app] {
    write_stdout(bash_completion(app.app()));
  });
}

} // namespace cowgpu::cli
