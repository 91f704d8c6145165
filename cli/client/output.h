// What the commands print: text for people, or with --json exactly one JSON document on standard
// output and nothing else there. Progress and errors go to standard error.
#pragma once

#include <mutex>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "absl/status/status.h"

namespace google::protobuf {
class Message;
}

namespace mortise::cli {

class Output {
 public:
  enum class Form {
    kText,    // for people
    kJson,    // one document
    kSilent,  // nothing; the document is kept for the caller
  };

  explicit Output(Form form) : form_(form) {}

  bool text() const { return form_ == Form::kText; }
  bool json() const { return form_ == Form::kJson; }

  // A line for people; nothing with --json.
  void Line(const std::string& text) const;

  // A table for people: column titles, then rows of as many cells.
  void Table(const std::vector<std::string>& titles,
             const std::vector<std::vector<std::string>>& rows) const;

  // The result as one JSON document: printed with --json, kept in either case.
  void Document(const nlohmann::ordered_json& document);
  void DocumentOf(const google::protobuf::Message& message);

  // Returns the text of the last document, empty if there was none.
  const std::string& last_document() const { return last_document_; }

  // Redraws the progress bar (a plain line now and then where standard error is no terminal).
  // `done` of `total` (0: unknown), with a text after it.
  void Progress(long done, long total, const std::string& text);

  // A line on standard error beside the progress: what a person should know while a command works.
  void Note(const std::string& text);

  // Ends the progress bar's line, if one was begun.
  void EndProgress();

  // Says what went wrong on standard error; with --json also as the document {"error": {...}}.
  // Returns the exit code (ExitCodeOf).
  int Failure(const absl::Status& status);

 private:
  void BreakProgress();

  const Form form_;
  std::mutex mutex_;            // of standard error; signals are told of on a thread of their own
  bool progress_open_ = false;  // guarded by mutex_
  std::string last_progress_;   // guarded by mutex_
  std::string last_document_;
};

// Returns the proto3 JSON of a message, field names as in the proto.
nlohmann::ordered_json ToJson(const google::protobuf::Message& message);

}  // namespace mortise::cli
