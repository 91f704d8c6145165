// mortise-notes: notes as a process.
#include "tests/integration/common/notes/notes_service.h"

int main(int argc, char** argv) {
  return mortise::rpc::RunService(argc, argv, {.name = "notes", .title = "Keeps notes"},
                                  mortise::notes::MakeServices);
}
