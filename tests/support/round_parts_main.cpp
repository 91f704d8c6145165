// round-parts FOLDER: writes bearing.step (7 round parts) and pin-board.step (175 parts), to import
// by hand.
#include <cstdio>
#include <filesystem>

#include "common/base/files.h"
#include "tests/support/round_parts.h"

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "round-parts FOLDER\n");
    return 2;
  }
  const std::filesystem::path folder = argv[1];
  const bool is_written =
      mortise::WriteFile(folder / "bearing.step", mortise::testing::BearingStep()).ok() &&
      mortise::WriteFile(folder / "pin-board.step", mortise::testing::PinBoardStep(58)).ok();
  if (!is_written) std::fprintf(stderr, "cannot write to %s\n", argv[1]);
  return is_written ? 0 : 1;
}
