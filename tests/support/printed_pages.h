// What is printed, read by programs that share nothing with what wrote it.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "common/base/files.h"
#include "tests/support/child_process.h"
#include "tests/support/temporary_folder.h"

namespace mortise::testing {

// Keeps a file where a person wants to look at it: in the folder that MORTISE_TEST_OUTPUT names.
inline void KeepToLookAt(const std::string& file_name, const std::string& bytes) {
  if (const char* folder = std::getenv("MORTISE_TEST_OUTPUT")) {
    EXPECT_TRUE(WriteFile(std::filesystem::path(folder) / file_name, bytes).ok());
  }
}

// Runs a reader of poppler or zbar to its end, and returns what it wrote.
inline std::string OutputOf(const std::vector<std::string>& command) {
  ChildProcess reader(command);
  EXPECT_EQ(reader.Wait(), 0) << command.front();
  return reader.Output();
}

// A PDF as pages of text.
inline std::vector<std::string> TextPagesOf(const std::string& pdf) {
  const TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "file.pdf", text = folder.path() / "text";
  EXPECT_TRUE(WriteFile(file, pdf).ok());
  OutputOf({"/usr/bin/pdftotext", "-q", "-layout", file.string(), text.string()});
  const auto read = ReadFile(text);
  EXPECT_TRUE(read.ok()) << read.status();
  std::vector<std::string> pages = absl::StrSplit(read.value_or(""), '\f');
  if (!pages.empty()) pages.pop_back();  // each page ends with a form feed
  return pages;
}

// The texts of all QR codes on a page of a PDF, from 1, as a printer draws it, sorted.
inline std::vector<std::string> CodesOn(const std::string& pdf, int page) {
  const TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "file.pdf", picture = folder.path() / "page";
  EXPECT_TRUE(WriteFile(file, pdf).ok());
  OutputOf({"/usr/bin/pdftoppm", "-q", "-r", "200", "-png", "-singlefile", "-f",
            std::to_string(page), "-l", std::to_string(page), file.string(), picture.string()});
  const std::string output =
      OutputOf({"/usr/bin/zbarimg", "--quiet", "--nodbus", "--raw", "-Sdisable", "-Sqrcode.enable",
                absl::StrCat(picture.string(), ".png")});
  std::vector<std::string> codes =
      absl::StrSplit(absl::StripAsciiWhitespace(output), '\n', absl::SkipEmpty());
  std::sort(codes.begin(), codes.end());
  return codes;
}

}  // namespace mortise::testing
