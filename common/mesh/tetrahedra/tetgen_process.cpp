#include "common/mesh/tetrahedra/tetgen_process.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <memory>
#include <new>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"

namespace mortise::mesh {
namespace {

// By how much longer than its processor time a child may take on a busy machine, before it counts
// as one that waits for something that never comes.
constexpr unsigned kPatience = 20;

// What the child tells first: a failure, or how much follows.
struct Head {
  // 0, or what TetGen throws: 1 out of memory; 2 internal; 3 self-intersection; 4 tiny features;
  // 5 tiny angles.
  int failure = 0;
  int points = 0;
  int tetrahedra = 0;
  int corners = 0;
  int triangles = 0;
};
constexpr int kOutOfMemory = 1;
constexpr int kUnknown = 2;

bool WriteAll(int descriptor, const void* data, std::size_t size) {
  const char* next = static_cast<const char*>(data);
  while (size > 0) {
    const ssize_t count = ::write(descriptor, next, size);
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return false;
    next += count;
    size -= static_cast<std::size_t>(count);
  }
  return true;
}

bool ReadAll(int descriptor, void* data, std::size_t size) {
  char* next = static_cast<char*>(data);
  while (size > 0) {
    const ssize_t count = ::read(descriptor, next, size);
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return false;
    next += count;
    size -= static_cast<std::size_t>(count);
  }
  return true;
}

template <typename Number>
bool WriteNumbers(int descriptor, const Number* numbers, int count) {
  return WriteAll(descriptor, numbers, sizeof(Number) * static_cast<std::size_t>(count));
}

template <typename Number>
bool ReadNumbers(int descriptor, Number*& numbers, int count) {
  numbers = new Number[static_cast<std::size_t>(count)];
  return ReadAll(descriptor, numbers, sizeof(Number) * static_cast<std::size_t>(count));
}

// In the child: meshes, and tells what came out.
void Tetrahedralize(const std::string& switches, int seconds, tetgenio& input, int descriptor) {
  // Not one that outlives a parent that was killed, nor one that leaves gigabytes when it crashes,
  // nor one that speaks where the parent does.
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  const rlimit no_core = {0, 0};
  ::setrlimit(RLIMIT_CORE, &no_core);
  const auto limit = static_cast<rlim_t>(seconds);
  const rlimit time = {limit, limit};
  ::setrlimit(RLIMIT_CPU, &time);
  // What asks the parent to end does not ask its child, which is waited for.
  ::signal(SIGINT, SIG_IGN);
  ::signal(SIGTERM, SIG_IGN);
  ::signal(SIGALRM, SIG_DFL);
  sigset_t alarm;
  ::sigemptyset(&alarm);
  ::sigaddset(&alarm, SIGALRM);
  ::sigprocmask(SIG_UNBLOCK, &alarm, nullptr);
  ::alarm(kPatience * static_cast<unsigned>(seconds));
  const int nowhere = ::open("/dev/null", O_WRONLY);
  ::dup2(nowhere, STDOUT_FILENO);
  ::dup2(nowhere, STDERR_FILENO);
  std::srand(1);  // TetGen asks for random numbers
  std::string text = switches;
  Head head;
  tetgenio output;
  try {
    tetrahedralize(text.data(), &input, &output);
  } catch (int code) {
    head.failure = code == 0 ? kUnknown : code;
  } catch (const std::bad_alloc&) {
    head.failure = kOutOfMemory;
  } catch (const std::exception&) {
    head.failure = kUnknown;
  }
  if (head.failure != 0) {
    WriteAll(descriptor, &head, sizeof(head));
    return;
  }
  head.points = output.numberofpoints;
  head.tetrahedra = output.numberoftetrahedra;
  head.corners = output.numberofcorners;
  head.triangles = output.numberoftrifaces;
  WriteAll(descriptor, &head, sizeof(head)) &&
      WriteNumbers(descriptor, output.pointlist, 3 * head.points) &&
      WriteNumbers(descriptor, output.tetrahedronlist, head.corners * head.tetrahedra) &&
      WriteNumbers(descriptor, output.tetrahedronattributelist, head.tetrahedra) &&
      WriteNumbers(descriptor, output.trifacelist, 3 * head.triangles) &&
      WriteNumbers(descriptor, output.trifacemarkerlist, head.triangles);
}

// In the parent. False if the child did not say all.
bool Receive(int descriptor, Head& head, tetgenio& output) {
  if (!ReadAll(descriptor, &head, sizeof(head))) return false;
  if (head.failure != 0) return true;
  output.numberofpoints = head.points;
  output.numberoftetrahedra = head.tetrahedra;
  output.numberofcorners = head.corners;
  output.numberoftetrahedronattributes = 1;
  output.numberoftrifaces = head.triangles;
  return ReadNumbers(descriptor, output.pointlist, 3 * head.points) &&
         ReadNumbers(descriptor, output.tetrahedronlist, head.corners * head.tetrahedra) &&
         ReadNumbers(descriptor, output.tetrahedronattributelist, head.tetrahedra) &&
         ReadNumbers(descriptor, output.trifacelist, 3 * head.triangles) &&
         ReadNumbers(descriptor, output.trifacemarkerlist, head.triangles);
}

absl::Status CannotStart(const char* what) {
  return absl::InternalError(
      absl::StrCat("meshing failed: no ", what, " for TetGen: ", std::strerror(errno)));
}

}  // namespace

absl::Status RunTetGen(const std::string& switches, int seconds, tetgenio& input,
                       tetgenio& output) {
  std::array<int, 2> ends = {-1, -1};
  if (::pipe2(ends.data(), O_CLOEXEC) != 0) return CannotStart("pipe");
  const pid_t child = ::fork();
  if (child < 0) {
    const absl::Status failure = CannotStart("process");
    ::close(ends[0]);
    ::close(ends[1]);
    return failure;
  }
  if (child == 0) {
    ::close(ends[0]);
    Tetrahedralize(switches, seconds, input, ends[1]);
    // Without destructors: they are the parent's to run.
    ::_exit(0);
  }
  ::close(ends[1]);
  Head head;
  bool is_whole = false;
  bool is_memory_short = false;
  try {
    is_whole = Receive(ends[0], head, output);
  } catch (const std::bad_alloc&) {
    is_memory_short = true;
  }
  // A child that is still writing ends by this.
  ::close(ends[0]);
  while (::waitpid(child, nullptr, 0) < 0 && errno == EINTR) {
  }
  if (is_memory_short || head.failure == kOutOfMemory) {
    return TooLarge("mesh", "the memory at hand");
  }
  if (!is_whole) {
    return absl::InternalError(
        absl::StrCat("meshing failed: TetGen crashed, or came to no end within ", seconds, " s"));
  }
  if (head.failure != 0) {
    return absl::InternalError(absl::StrCat("meshing failed: TetGen error ", head.failure));
  }
  if (head.tetrahedra == 0) return absl::InternalError("meshing failed: no elements came out");
  return absl::OkStatus();
}

}  // namespace mortise::mesh
