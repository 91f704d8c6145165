// What dragging costs: designs of 100 and 500 elements of which no two are alike, and a cabinet
// that ships, while a hand goes to and fro. Printed are the milliseconds of processor time that
// half and 99 of 100 values take at most, and how many times as long a drag takes of which nothing
// is prepared. The goal is 5 ms at 100 elements and 100 ms at 500.
#include <algorithm>
#include <cstdio>
#include <ctime>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "services/composer/model/controls.h"
#include "services/composer/model/node_drag.h"
#include "tests/unit/common/assembly/bookcase.h"
#include "tests/unit/services/composer/shipped_designs.h"

namespace mortise::composer {
namespace {

struct Scene {
  std::string name;
  Design design;
  std::string node;
  ControlKind kind;
  Axis axis;
};

// Processor milliseconds.
double TimeOf(const std::function<void()>& work) {
  const auto now = [] {
    timespec time;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
    return 1e3 * static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_nsec);
  };
  const double begin = now();
  work();
  return now() - begin;
}

double At(std::vector<double> times, double share) {
  std::sort(times.begin(), times.end());
  const auto place = static_cast<std::size_t>(share * static_cast<double>(times.size()));
  return times[std::min(place, times.size() - 1)];
}

void Measure(const Scene& scene, int values) {
  std::fflush(stdout);
  std::shared_ptr<const DragSpace> space;
  const double structure =
      TimeOf([&] { space = std::make_shared<const DragSpace>(scene.design.assembly); });
  std::optional<NodeDrag> drag;
  const double node = TimeOf([&] {
    drag = NodeDrag::Begin(space, scene.design, scene.node, scene.kind, scene.axis).value();
  });
  const double now = drag->ValueIn(scene.design);
  std::vector<double> times;
  for (int i = 0; i < values; ++i) {
    // From a half to one and a half of what it is, to and fro.
    const double phase = 4.0 * i / values;
    const double way = phase - 2 * static_cast<int>(phase / 2);
    const double value = now * (0.5 + (way < 1 ? way : 2 - way));
    times.push_back(TimeOf([&] { drag->To(value).value(); }));
  }
  const double plain =
      TimeOf([&] { Drag(scene.design, scene.node, scene.kind, scene.axis, 1.1 * now).value(); });
  std::printf(
      "%-44s %5zu elements  p50 %7.2f ms  p99 %7.2f ms  structure %8.1f ms  node %7.1f ms  "
      "unprepared %5.1f times p50\n",
      scene.name.c_str(), scene.design.assembly->elements().size(), At(times, 0.5), At(times, 0.99),
      structure, node, plain / At(times, 0.5));
}

}  // namespace
}  // namespace mortise::composer

int main() {
  using namespace mortise;            // NOLINT: a program of its own
  using namespace mortise::composer;  // NOLINT
  const Design cabinet = ShippedDesign("cabinet");
  Measure({"cabinet: width", cabinet, "", ControlKind::kSize, Axis::kX}, 400);
  Measure({"cabinet: height", cabinet, "", ControlKind::kSize, Axis::kZ}, 400);
  for (const auto& [columns, shelves] : {std::pair(11, 9), std::pair(51, 9)}) {
    const Design bookcase = AsDrawn(parametric::Bookcase(columns, shelves)).value();
    Measure({"bookcase: width", bookcase, "", ControlKind::kSize, Axis::kX}, 400);
    Measure({"bookcase: height", bookcase, "", ControlKind::kSize, Axis::kZ}, 400);
    Measure(
        {"bookcase: a shelf up and down", bookcase, "shelf 5 3", ControlKind::kCenter, Axis::kZ},
        400);
  }
}
