#include "common/mesh/scenes/scene_reader.h"

#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <new>
#include <utility>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/base/isolated_child.h"
#include "common/mesh/scenes/scene_encoding.h"
#include "common/mesh/scenes/scene_import.h"

namespace mortise::mesh {
namespace {

// What the child says begins with one of these; a message or an encoded scene follows.
constexpr std::string_view kInvalid = "invalid ";
constexpr std::string_view kTooLarge = "too-large ";
constexpr std::string_view kScene = "scene ";

constexpr std::string_view kMemory = "what can be read in 1 GiB of memory";

// The question is the file's name, an end of line, and the file.
constexpr std::size_t kMaxFileName = 4096;  // bytes

// The largest scene: 2,000,000 triangles that share no vertices, with room for names.
constexpr std::size_t kMaxAnswer = kMaxSceneTriangles * (3 * 3 * sizeof(double) + 3 * sizeof(int)) +
                                   kMaxSceneComponents * (kMaxSceneNameBytes + 64) +
                                   (std::size_t{1} << 20);

// So that an allocation that fails, wherever in the libraries, is told as what it is.
void SayMemoryIsShort() {
  WriteAnswer(kTooLarge);
  WriteAnswer(kMemory);
  ::_exit(0);
}

bool TakePrefix(std::string_view& text, std::string_view prefix) {
  if (!text.starts_with(prefix)) return false;
  text.remove_prefix(prefix.size());
  return true;
}

absl::StatusOr<Scene> Understand(const ChildAnswer& answer) {
  std::string_view text = answer.bytes;
  if (answer.end == ChildAnswer::End::kAnswerTooLong) return TooLarge("file", kMemory);
  if (answer.end == ChildAnswer::End::kOutOfTime) {
    return TooLarge("file", "what can be read in time");
  }
  if (answer.signal == SIGXCPU) {
    return TooLarge("file", absl::StrCat("what can be read in ", kMaxSceneProcessorTime.count(),
                                         " s of processor time"));
  }
  if (answer.signal == 0) {
    if (TakePrefix(text, kInvalid)) return InvalidField("file", text);
    if (TakePrefix(text, kTooLarge)) return TooLarge("file", text);
    if (TakePrefix(text, kScene)) return DecodeScene(text);
  }
  return InvalidField("file", "is damaged: the library that reads it fails over it");
}

}  // namespace

int RunSceneChild() {
  LimitChildMemory(MappedMemory() + kMaxSceneMemory);
  LimitChildTime(kMaxSceneProcessorTime);
  std::set_new_handler(SayMemoryIsShort);
  const std::string question = ReadQuestion(kMaxFileName + 1 + kMaxSceneBytes);
  const std::size_t end = std::min(question.find('\n'), question.size());
  std::string_view bytes = question;
  bytes.remove_prefix(std::min(end + 1, bytes.size()));
  const absl::StatusOr<Scene> scene = ImportScene(bytes, std::string_view(question).substr(0, end));
  if (scene.ok()) {
    const std::string encoded = EncodeScene(*scene);
    WriteAnswer(kScene);
    WriteAnswer(encoded);
  } else {
    std::string_view message(scene.status().message().data(), scene.status().message().size());
    const bool is_large = absl::IsResourceExhausted(scene.status());
    for (const std::string_view prefix : {"file: ", "file is larger than "}) {
      TakePrefix(message, prefix);
    }
    WriteAnswer(is_large ? kTooLarge : kInvalid);
    WriteAnswer(message);
  }
  // Without destructors: the library's, over a damaged file, may crash.
  ::_exit(0);
}

absl::StatusOr<Scene> ReadScene(std::string_view bytes, std::string_view file_name,
                                const SceneReaderOptions& options) {
  if (bytes.size() > kMaxSceneBytes) return TooLarge("file", "64 MiB");
  ChildOptions child;
  child.program = options.program;
  child.argument = kSceneChildArgument;
  child.time_limit = options.time_limit;
  child.max_answer = kMaxAnswer;
  std::string question(
      file_name.substr(file_name.size() - std::min(file_name.size(), kMaxFileName)));
  std::replace(question.begin(), question.end(), '\n', ' ');
  question.reserve(question.size() + 1 + bytes.size());
  question.append("\n").append(bytes);
  MORTISE_ASSIGN_OR_RETURN(const ChildAnswer answer, AskChild(question, child));
  return Understand(answer);
}

}  // namespace mortise::mesh
