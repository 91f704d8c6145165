// What libraries throw where memory ends never leaves the mapping.
#include <gtest/gtest.h>

#include <cstdlib>
#include <functional>
#include <new>
#include <random>
#include <stdexcept>

#include "services/interpolator/mapping/disk_map.h"
#include "services/interpolator/mapping/guarded.h"
#include "services/interpolator/mapping/nearest_place.h"
#include "tests/unit/services/interpolator/mapping/block_shapes.h"
#include "tests/unit/services/interpolator/mapping/patches.h"

namespace {

// How many allocations of this thread succeed before one fails; none fails where it is negative.
thread_local int allocations_left = -1;

void* Allocate(std::size_t size) {
  if (allocations_left >= 0 && allocations_left-- == 0) throw std::bad_alloc();
  if (void* const memory = std::malloc(size == 0 ? 1 : size)) return memory;
  throw std::bad_alloc();
}

}  // namespace

void* operator new(std::size_t size) { return Allocate(size); }
void* operator new[](std::size_t size) { return Allocate(size); }
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }
void operator delete[](void* memory) noexcept { std::free(memory); }
void operator delete[](void* memory, std::size_t) noexcept { std::free(memory); }

namespace mortise::interpolator {
namespace {

// Lets one allocation after the other fail until none is left that `work` needs. Each time it must
// say so or do without.
void FailEachAllocation(const std::function<absl::Status()>& work) {
  int failed = 0;
  for (int n = 0; n < 100'000; ++n) {
    allocations_left = n;
    const absl::Status status = work();
    const bool has_failed = allocations_left < 0;
    allocations_left = -1;
    if (!has_failed) {
      EXPECT_TRUE(status.ok()) << status;
      EXPECT_GT(failed, 10);
      return;
    }
    EXPECT_TRUE(absl::IsResourceExhausted(status)) << n << ": " << status;
    ++failed;
  }
  ADD_FAILURE() << "it never ends";
}

TEST(OutOfMemoryTest, IsSaidWhereNearestPlacesAreSearched) {
  const mesh::SurfaceMesh box =
      MakeBlockMesh(BoxShape({1, 2, 3}), {.along = 2, .across = 2, .high = 2}).marked.surface;
  FailEachAllocation([&box] {
    const auto nearest = NearestPlaces::Create(box);
    if (!nearest.ok()) return nearest.status();
    return nearest->Find({0.4, 1.3, 4}).status();
  });
}

TEST(OutOfMemoryTest, IsSaidWherePatchesAreFlattened) {
  std::mt19937 random(3);
  const DiskPatch patch = RandomPatch(random, 3, 0.4);
  const Eigen::Matrix2Xd circle = OnCircle(patch);
  FailEachAllocation([&] { return DiskMap::Create(patch, circle).status(); });
}

TEST(OutOfMemoryTest, BecomesAStatusAsAllThatIsThrown) {
  const auto thrown = [](const std::function<void()>& what) {
    return Guarded([&what] {
      what();
      return absl::OkStatus();
    });
  };
  EXPECT_TRUE(absl::IsResourceExhausted(thrown([] { throw std::bad_alloc(); })));
  const absl::Status logic = thrown([] { throw std::logic_error("an edge is missing"); });
  EXPECT_TRUE(absl::IsInternal(logic));
  EXPECT_EQ(logic.message(), "an exception: an edge is missing");
  EXPECT_TRUE(absl::IsInternal(thrown([] { throw 7; })));
}

}  // namespace
}  // namespace mortise::interpolator
