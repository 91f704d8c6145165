#include "cli/launcher/port_holder.h"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>
#include <string_view>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"

namespace mortise::cli {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kListening = "0A";  // a state, in hexadecimal digits

// Adds the inodes of the sockets that listen on a port, as a table of the kernel has them: a line
// is "sl local_address rem_address st tx:rx tr:when retrnsmt uid timeout inode …".
void AddListeners(const fs::path& table, int port, std::set<std::string>& inodes) {
  std::ifstream in(table);
  std::string line;
  std::getline(in, line);  // the titles
  const std::string ending = absl::StrFormat(":%04X", port);
  while (std::getline(in, line)) {
    std::istringstream words(line);
    std::string number, local, remote, state, queues, timer, retransmits, user, timeout, inode;
    words >> number >> local >> remote >> state >> queues >> timer >> retransmits >> user >>
        timeout >> inode;
    if (state == kListening && local.ends_with(ending)) inodes.insert(inode);
  }
}

// Whether a process has one of these sockets open.
bool HasSocket(const fs::path& process, const std::set<std::string>& inodes) {
  std::error_code error;
  for (auto entry = fs::directory_iterator(process / "fd", error);
       !error && entry != fs::directory_iterator(); entry.increment(error)) {
    std::error_code gone;
    const std::string target = fs::read_symlink(entry->path(), gone).string();
    constexpr std::string_view kSocket = "socket:[";
    if (gone || !target.starts_with(kSocket)) continue;
    if (inodes.contains(target.substr(kSocket.size(), target.size() - kSocket.size() - 1))) {
      return true;
    }
  }
  return false;
}

// What a process is called: the program that it runs, as the kernel's own name is cut short.
std::string NameOf(const fs::path& process) {
  std::string program;
  std::getline(std::ifstream(process / "cmdline"), program, '\0');
  return fs::path(program).filename().string();
}

bool IsNumber(const std::string& text) {
  return !text.empty() && std::all_of(text.begin(), text.end(),
                                      [](unsigned char c) { return std::isdigit(c) != 0; });
}

}  // namespace

std::string PortHolder(int port) {
  std::set<std::string> inodes;
  for (const char* const table : {"/proc/net/tcp", "/proc/net/tcp6"}) {
    AddListeners(table, port, inodes);
  }
  if (inodes.empty()) return "";
  std::error_code error;
  for (auto entry = fs::directory_iterator("/proc", error);
       !error && entry != fs::directory_iterator(); entry.increment(error)) {
    const std::string id = entry->path().filename().string();
    if (!IsNumber(id) || !HasSocket(entry->path(), inodes)) continue;
    return absl::StrCat(NameOf(entry->path()), " (process ", id, ")");
  }
  return "";
}

}  // namespace mortise::cli
