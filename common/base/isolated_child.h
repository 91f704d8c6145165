// Does one risky piece of work in a child process: reading what strangers send with a library that
// crashes, hangs or takes all memory over damaged files.
//
// The child is a program of ours, as a rule this one, started anew with an argument that its main()
// knows. It reads its question from standard input and writes its answer to standard output. The
// parent outlives whatever becomes of it.
#pragma once

#include <chrono>
#include <cstddef>
#include <functional>
#include <string>
#include <string_view>

#include "absl/status/statusor.h"

namespace mortise {

struct ChildOptions {
  std::string program = "/proc/self/exe";
  std::string argument;                           // which makes the program a child; its only one
  std::chrono::seconds time_limit{120};           // by the clock
  std::size_t max_answer = std::size_t{1} << 30;  // bytes
  // Is told each piece of the answer as it comes, for those who show how far the child is.
  std::function<void(std::string_view piece)> heard = {};
  // Is asked several times a second; the child is killed soon after it says so. Unset: never.
  std::function<bool()> is_given_up = {};
};

struct ChildAnswer {
  enum class End {
    kFinished,       // the child closed its end, by itself or because it crashed
    kOutOfTime,      // it was killed, because `time_limit` was over
    kAnswerTooLong,  // it was killed, because it answered with more than `max_answer`
    kGivenUp,        // it was killed, because nobody waits for the answer any more
  };
  std::string bytes;  // what it wrote until then
  End end = End::kFinished;
  int signal = 0;  // that ended a finished child, SIGXCPU if its processor time was up; 0 for none
};

// Starts a child, sends it `question`, and waits for its answer. When this returns, the child has
// ended. Any number may run at once. INTERNAL if no child can be started.
absl::StatusOr<ChildAnswer> AskChild(std::string_view question, const ChildOptions& options);

// ---- What the child calls -----------------------------------------------------------------------

// Limits the child's addresses to so many bytes and lets it leave no core file. Nothing is limited
// under the address sanitizer, which reserves addresses without end.
void LimitChildMemory(std::size_t bytes);

// Returns the addresses that the child takes now, bytes: of its program and of the libraries it
// loads.
std::size_t MappedMemory();

// Limits the child's processor time; so it also ends when its parent was killed. Of processor time,
// because a busy machine is no fault of the file.
void LimitChildTime(std::chrono::seconds limit);

// Returns the question, or its first bytes, at least `limit` + 1, if it is longer than `limit`.
std::string ReadQuestion(std::size_t limit);

// Writes a piece of the answer, as far as the parent still listens.
void WriteAnswer(std::string_view bytes);

}  // namespace mortise
