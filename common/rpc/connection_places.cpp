#include "common/rpc/connection_places.h"

#include <sys/stat.h>

namespace mortise::rpc {

bool ConnectionPlaces::Full(int taken) {
  if (static_cast<int>(places_.size()) + taken < most_) return false;
  ForgetClosed();
  return static_cast<int>(places_.size()) + taken >= most_;
}

void ConnectionPlaces::Enter(int descriptor) {
  struct stat status = {};
  if (fstat(descriptor, &status) == 0) places_.push_back({descriptor, status.st_ino});
}

void ConnectionPlaces::ForgetClosed() {
  std::erase_if(places_, [](const Place& place) {
    struct stat status = {};
    return fstat(place.descriptor, &status) != 0 || !S_ISSOCK(status.st_mode) ||
           status.st_ino != place.socket;
  });
}

}  // namespace mortise::rpc
