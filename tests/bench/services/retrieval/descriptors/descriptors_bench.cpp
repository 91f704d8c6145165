// What a shape's descriptor costs on one core: of a scanned or downloaded surface of 50,000
// triangles, and of a template's own surface of some 2,000. Goals: D2 100 and 15 ms, light field
// 200 and 20 ms. All four quarter turns are in it. Then the derivatives by four parameters.
#include <benchmark/benchmark.h>

#include <memory>
#include <string>
#include <vector>

#include "services/retrieval/descriptors/descriptor.h"
#include "services/retrieval/descriptors/descriptor_jacobian.h"
#include "tests/unit/common/mesh/round_solids.h"
#include "tests/unit/services/retrieval/descriptors/furniture.h"

namespace mortise::retrieval {
namespace {

using mesh::SurfaceMesh;

// 49,928 triangles: a torus, all of whose triangles are small.
SurfaceMesh Scan() { return mesh::Torus(1, 0.4, 158); }

// 1,944 triangles, most of them long: 27 chairs, six boards each, in rows.
SurfaceMesh Template(const Eigen::Vector4d& q) {
  std::vector<SurfaceMesh> chairs;
  for (int i = 0; i < 27; ++i) {
    chairs.push_back(mesh::Moved(Chair(q), {0.7 * (i % 3), 0.8 * (i / 3 % 3), 1.1 * (i / 9)}));
  }
  return Joined(chairs);
}

const Eigen::Vector4d kMiddle(0.45, 0.5, 0.42, 0.4);

void Describe(benchmark::State& state, const std::string& name, const SurfaceMesh& surface) {
  const std::unique_ptr<Descriptor> descriptor = *MakeDescriptor(name);
  for (auto unused : state) {
    benchmark::DoNotOptimize(descriptor->QuarterTurns(*descriptor->Describe(surface)));
  }
  state.counters["triangles"] = static_cast<double>(surface.triangles.cols());
}

void Differentiate(benchmark::State& state, const std::string& name) {
  const SurfaceFamily family{(kMiddle.array() - 0.1).matrix(), (kMiddle.array() + 0.1).matrix(),
                             [](const Eigen::VectorXd& q) { return Template(q); }};
  const std::unique_ptr<BoundDescriptor> bound = *(*MakeDescriptor(name))->Bind(Template(kMiddle));
  for (auto unused : state) {
    benchmark::DoNotOptimize(DescriptorJacobian(*bound, family, kMiddle)->jacobian.data());
  }
}

const int registered = [] {
  for (const std::string& name : DescriptorNames()) {
    benchmark::RegisterBenchmark(("Describe/scan/" + name).c_str(), Describe, name, Scan())
        ->Unit(benchmark::kMillisecond);
    benchmark::RegisterBenchmark(("Describe/template/" + name).c_str(), Describe, name,
                                 Template(kMiddle))
        ->Unit(benchmark::kMillisecond);
    benchmark::RegisterBenchmark(("Differentiate/template/" + name).c_str(), Differentiate, name)
        ->Unit(benchmark::kMillisecond);
  }
  return 0;
}();

}  // namespace
}  // namespace mortise::retrieval

BENCHMARK_MAIN();
