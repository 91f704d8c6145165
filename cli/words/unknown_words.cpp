#include "cli/words/unknown_words.h"

#include <algorithm>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "common/base/names/offered_names.h"

namespace mortise::cli {
namespace {

// A command as a person types it: "mortise catalog list".
std::string PathOf(const CLI::App& command) {
  const CLI::App* const parent = command.get_parent();
  return parent == nullptr ? command.get_name()
                           : absl::StrCat(PathOf(*parent), " ", command.get_name());
}

std::vector<std::string> CommandsOf(const CLI::App& command) {
  std::vector<std::string> names;
  for (const CLI::App* const each : command.get_subcommands([](const CLI::App*) { return true; })) {
    names.push_back(each->get_name());
  }
  return names;
}

// Those of a command and of all that it is part of.
std::vector<std::string> OptionsOf(const CLI::App& command) {
  std::vector<std::string> names;
  for (const CLI::App* app = &command; app != nullptr; app = app->get_parent()) {
    for (const CLI::Option* const option :
         app->get_options([](const CLI::Option*) { return true; })) {
      for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
    }
  }
  return names;
}

std::string NoOption(const std::string& word, const CLI::App& command) {
  const std::string name = word.substr(0, word.find('='));
  return absl::StrCat("there is no option '", name, "' of ", PathOf(command),
                      NearestOffered(name, OptionsOf(command)));
}

std::string NoCommand(const std::string& word, const CLI::App& command) {
  const std::vector<std::string> commands = CommandsOf(command);
  if (commands.empty())
    return absl::StrCat("'", word, "' is one word too many for ", PathOf(command));
  const bool is_first = command.get_parent() == nullptr;
  return absl::StrCat("there is no command '", word, "'", is_first ? "" : " of ",
                      is_first ? "" : PathOf(command), NamesOffered(word, commands));
}

}  // namespace

std::string UnknownWords(const CLI::App& app, const std::vector<std::string>& arguments) {
  std::vector<std::string> left = app.remaining(/*recurse=*/true);
  std::vector<std::string> texts;
  const CLI::App* command = &app;
  bool may_be_value = false;  // of the option before, which there is not
  for (const std::string& word : arguments) {
    const auto found = std::find(left.begin(), left.end(), word);
    const bool is_option = word.starts_with('-');
    if (found == left.end()) {
      may_be_value = false;
      const auto is_it = [&word](const CLI::App* each) { return each->get_name() == word; };
      const std::vector<const CLI::App*> next = command->get_subcommands(is_it);
      if (!next.empty()) command = next.front();
      continue;
    }
    left.erase(found);
    if (word == "--") continue;
    if (is_option) {
      texts.push_back(NoOption(word, *command));
    } else if (!may_be_value) {
      texts.push_back(NoCommand(word, *command));
    }
    may_be_value = is_option && word.find('=') == std::string::npos;
  }
  return absl::StrJoin(texts, "\n");
}

}  // namespace mortise::cli
