// A page that needs no server, as a browser sees it.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "absl/strings/str_split.h"
#include "tests/support/child_process.h"
#include "tests/support/temporary_folder.h"

namespace mortise::testing {

// What a page has said on the console: each is a fault, but for what the driver says of how slow it
// is to be asked for the picture.
inline std::string ConsoleOf(const std::string& output) {
  std::string lines;
  for (const auto line : absl::StrSplit(output, '\n')) {
    if (absl::StrContains(line, ":CONSOLE") &&
        !absl::StrContains(line, "stall due to ReadPixels")) {
      absl::StrAppend(&lines, line, "\n");
    }
  }
  return lines;
}

// Opens a page in a headless browser, at an address that ends in `hash` and asks for its self-test,
// and with more flags if need be. Returns what the self-test says. Whatever the page meets as a
// fault fails the test.
inline nlohmann::json OpenPageAt(const std::filesystem::path& page, const std::string& hash,
                                 const std::vector<std::string>& flags = {}) {
  const TemporaryFolder profile;
  std::vector<std::string> command = {
      "/usr/lib/chromium/chromium-headless-shell", "--headless", "--no-sandbox", "--disable-gpu",
      "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--disable-background-networking",
      "--disable-quic", "--disable-component-update", "--disable-sync", "--no-first-run",
      "--window-size=1280,800", "--user-data-dir=" + profile.path().string(),
      "--enable-logging=stderr",
      // Time goes by as nothing is left to do; a page in its self-test holds it.
      "--virtual-time-budget=10000000", "--dump-dom"};
  command.insert(command.end(), flags.begin(), flags.end());
  command.push_back(absl::StrCat("file://", std::filesystem::absolute(page).string(), hash));
  ChildProcess browser(command);
  EXPECT_EQ(browser.Wait(), 0);
  const std::string output = browser.Output();
  EXPECT_EQ(ConsoleOf(output), "");
  const std::string begin = "id=\"self-test\">";
  const std::size_t first = output.find(begin);
  EXPECT_NE(first, std::string::npos) << output.substr(0, 2000);
  if (first == std::string::npos) return nlohmann::json::object();
  const std::size_t from = first + begin.size();
  nlohmann::json told = nlohmann::json::parse(
      output.substr(from, output.find("</script>", from) - from), nullptr, false);
  EXPECT_EQ(told["faults"], nlohmann::json::array());
  return told;
}

// Opens the page of a map, and returns what its self-test (cli/explore/page/self_test.mjs) says of
// these designs, the values of all parameters of each.
inline nlohmann::json OpenPage(const std::filesystem::path& page,
                               const std::vector<std::vector<double>>& designs,
                               const std::vector<std::string>& flags = {}) {
  std::vector<std::string> points;
  for (const std::vector<double>& design : designs) {
    points.push_back(absl::StrJoin(design, ",", [](std::string* out, double number) {
      absl::StrAppendFormat(out, "%.17g", number);
    }));
  }
  return OpenPageAt(page, absl::StrCat("#test=", absl::StrJoin(points, ";")), flags);
}

}  // namespace mortise::testing
