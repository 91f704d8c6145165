#include "services/retrieval/service/cover_making.h"

#include <memory>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "common/base/digest.h"
#include "common/base/errors.h"
#include "services/retrieval/cover/interpolated_cover.h"
#include "services/retrieval/families/family_cover.h"
#include "services/retrieval/families/family_manifold.h"
#include "services/retrieval/index/index_file.h"
#include "services/retrieval/service/index_records.h"

namespace mortise::retrieval {
namespace {

absl::StatusOr<Cover> CoverOf(const CompiledTemplate& compiled,
                              const std::shared_ptr<const Descriptor>& descriptor, double delta,
                              const std::stop_token& stop) {
  MORTISE_ASSIGN_OR_RETURN(const std::unique_ptr<Manifold> manifold,
                           MakeFamilyManifold(compiled.function, descriptor));
  CoverOptions options = FamilyCoverOptions(delta, *compiled.function);
  options.stop = stop;
  MORTISE_ASSIGN_OR_RETURN(Cover cover, CoverByInterpolation(*manifold, options));
  if (!cover.primitives.empty()) return cover;
  return absl::FailedPreconditionError("none of its designs can be made");
}

// The file of a cover that could be made, or its fault.
absl::Status Fill(const CompiledTemplate& compiled, const v1::WantedCover& wanted,
                  const std::stop_token& stop, CoverFile* file) {
  MORTISE_ASSIGN_OR_RETURN(const std::shared_ptr<const Descriptor> descriptor,
                           MakeDescriptor(IndexIdOf(wanted.shape_descriptor())));
  if (CoverDigest(*descriptor, wanted.delta(), compiled.digest) != wanted.digest()) {
    return PreconditionFailed("TEMPLATE_CHANGED",
                              absl::StrCat("items or materials of ", compiled.name,
                                           " have changed since its cover was asked for"),
                              compiled.name);
  }
  absl::StatusOr<Cover> cover = CoverOf(compiled, descriptor, wanted.delta(), stop);
  if (stop.stop_requested()) return absl::CancelledError("the cover was cancelled");
  if (!cover.ok()) {
    file->made.set_fault(std::string(cover.status().message()));
    return absl::OkStatus();
  }
  file->made.set_evaluations(cover->evaluations);
  file->made.set_failed_evaluations(cover->failures);
  file->made.set_truncated(cover->end != CoverEnd::kCovered);
  std::vector<FamilyCover> alone;
  alone.push_back({.family = 0, .primitives = std::move(cover->primitives)});
  MORTISE_ASSIGN_OR_RETURN(const PrimitiveIndex index, PrimitiveIndex::Build(std::move(alone)));
  MORTISE_ASSIGN_OR_RETURN(file->bytes, IndexBytes(index, FormatOf(*descriptor), kCoverVersion));
  return absl::OkStatus();
}

}  // namespace

std::string CoverDigest(const Descriptor& descriptor, double delta, const std::string& content) {
  return Sha256Hex(absl::StrFormat("%s %s %d %a %s", kCoverVersion, FormatOf(descriptor),
                                   descriptor.properties().dimension, delta, content));
}

absl::Status MakeCovers(const v1::CoverTask& task, TemplateSource& templates,
                        const rpc::Origin& origin, const std::stop_token& stop,
                        const KeepCover& keep) {
  const v1::ShapeIndex::Family& family = task.family();
  const absl::StatusOr<std::shared_ptr<const CompiledTemplate>> compiled =
      templates.Get(family.template_(), family.template_revision(), origin, family.group());
  if (absl::IsNotFound(compiled.status()) || IsPassingFailure(compiled.status())) {
    return compiled.status();
  }
  for (int i = 0; i < task.covers_size(); ++i) {
    const v1::WantedCover& wanted = task.covers(i);
    CoverFile file;
    file.made.set_shape_descriptor(wanted.shape_descriptor());
    file.made.set_digest(wanted.digest());
    if (compiled.ok()) {
      MORTISE_RETURN_IF_ERROR(Fill(**compiled, wanted, stop, &file));
    } else {
      file.made.set_fault(std::string(compiled.status().message()));
    }
    MORTISE_RETURN_IF_ERROR(keep(std::move(file), i + 1 == task.covers_size()));
  }
  return absl::OkStatus();
}

}  // namespace mortise::retrieval
