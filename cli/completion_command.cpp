// mortise completion: a script that teaches a shell the commands and options of this program.
#include <CLI/CLI.hpp>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "cli/session.h"
#include "common/base/errors.h"

namespace mortise::cli {
namespace {

// For each command path ("catalog list"), the words that can follow it.
void Collect(const CLI::App& app, const std::string& path,
             std::map<std::string, std::vector<std::string>>& words) {
  std::vector<std::string>& here = words[path];
  for (const CLI::App* child : app.get_subcommands(nullptr)) {
    here.push_back(child->get_name());
    Collect(*child, path.empty() ? child->get_name() : path + " " + child->get_name(), words);
  }
  for (const CLI::Option* option : app.get_options()) {
    for (const std::string& name : option->get_lnames()) here.push_back("--" + name);
  }
}

std::string BashScript(const CLI::App& app) {
  std::map<std::string, std::vector<std::string>> words;
  Collect(app, "", words);
  std::string cases;
  for (const auto& [path, following] : words) {
    absl::StrAppend(&cases, "    \"", path, "\") words=\"", absl::StrJoin(following, " "),
                    "\" ;;\n");
  }
  return absl::StrCat(R"(# bash completion for mortise: source <(mortise completion bash)
_mortise() {
  local path="" word words
  for word in "${COMP_WORDS[@]:1:COMP_CWORD-1}"; do
    case "$word" in -*) ;; *) path="${path:+$path }$word" ;; esac
  done
  case "$path" in
)",
                      cases, R"(    *) words="" ;;
  esac
  COMPREPLY=($(compgen -W "$words" -- "${COMP_WORDS[COMP_CWORD]}"))
  [ ${#COMPREPLY[@]} -gt 0 ] || COMPREPLY=($(compgen -f -- "${COMP_WORDS[COMP_CWORD]}"))
}
complete -F _mortise mortise)");
}

}  // namespace

void AddCompletionCommand(CLI::App& app, Session& session) {
  auto shell = std::make_shared<std::string>("bash");
  CLI::App* completion = app.add_subcommand("completion", "Print a shell completion script");
  completion->add_option("shell", *shell, "bash")->check(CLI::IsMember({"bash"}));
  completion->footer("Example: source <(mortise completion bash)");
  completion->callback([&app, &session, shell] {
    session.command = [&app](Session&, Output& output) {
      const std::string script = BashScript(app);
      output.Line(script);
      output.Document(nlohmann::ordered_json{{"shell", "bash"}, {"script", script}});
      return absl::OkStatus();
    };
  });
}

}  // namespace mortise::cli
