#include "services/retrieval/service/cover_making.h"

#include <time.h>

#include <cstddef>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "common/base/digest.h"
#include "common/base/errors.h"
#include "common/base/logging.h"
#include "services/retrieval/cover/interpolated_cover.h"
#include "services/retrieval/families/described_designs.h"
#include "services/retrieval/families/family_cover.h"
#include "services/retrieval/families/family_manifold.h"
#include "services/retrieval/index/index_file.h"
#include "services/retrieval/service/index_records.h"

namespace mortise::retrieval {
namespace {

// What a task asks for, ready to be made.
struct FamilyWork {
  const SearchedTemplate* compiled;
  std::vector<std::shared_ptr<const Descriptor>> descriptors;  // of each cover
  std::shared_ptr<DescribedDesigns> designs;                   // null where they share none
};

absl::StatusOr<FamilyWork> WorkOf(const v1::CoverTask& task, const SearchedTemplate& compiled) {
  FamilyWork work{.compiled = &compiled, .descriptors = {}, .designs = nullptr};
  for (const v1::WantedCover& wanted : task.covers()) {
    MORTISE_ASSIGN_OR_RETURN(std::shared_ptr<const Descriptor> descriptor,
                             MakeDescriptor(IndexIdOf(wanted.shape_descriptor())));
    if (CoverDigest(*descriptor, wanted.delta(), compiled.digest) != wanted.digest()) {
      return PreconditionFailed("TEMPLATE_CHANGED",
                                absl::StrCat("items or materials of ", compiled.name,
                                             " have changed since its cover was asked for"),
                                compiled.name);
    }
    work.descriptors.push_back(std::move(descriptor));
  }
  if (work.descriptors.size() > 1 && compiled.design_template->MeshesAnew()) {
    work.designs = std::make_shared<DescribedDesigns>(compiled.design_template, work.descriptors);
  }
  return work;
}

absl::StatusOr<Cover> CoverOf(const FamilyWork& work, std::size_t place, double delta,
                              const std::stop_token& stop) {
  MORTISE_ASSIGN_OR_RETURN(const std::unique_ptr<Manifold> manifold,
                           MakeFamilyManifold(work.compiled->design_template,
                                              work.descriptors[place], work.designs, place));
  CoverOptions options = FamilyCoverOptions(delta, *work.compiled->design_template);
  options.stop = stop;
  MORTISE_ASSIGN_OR_RETURN(Cover cover, CoverByInterpolation(*manifold, options));
  if (!cover.primitives.empty()) return cover;
  return absl::FailedPreconditionError("none of its designs can be made");
}

// Seconds that this thread has computed.
double ProcessorSeconds() {
  timespec time = {};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

// Tells what a cover took, so that what makes an index slow can be found.
void LogCover(const FamilyWork& work, std::size_t place, const CoverFile& file,
              std::size_t primitives, double seconds) {
  Log(LogLevel::kInfo, "covered a family",
      {{"template", work.compiled->name},
       {"group", work.compiled->group},
       {"index", work.descriptors[place]->properties().name},
       {"processor_seconds", seconds},
       {"evaluations", file.made.evaluations()},
       {"interpolation_error", file.made.interpolation_error()},
       {"primitives", primitives},
       {"fault", file.made.fault()}});
}

// The file of a cover that could be made, or its fault.
absl::Status Fill(const FamilyWork& work, std::size_t place, double delta,
                  const std::stop_token& stop, CoverFile* file) {
  const double before = ProcessorSeconds();
  absl::StatusOr<Cover> cover = CoverOf(work, place, delta, stop);
  const double seconds = ProcessorSeconds() - before;
  if (stop.stop_requested()) return absl::CancelledError("the cover was cancelled");
  if (!cover.ok()) {
    file->made.set_fault(std::string(cover.status().message()));
    LogCover(work, place, *file, 0, seconds);
    return absl::OkStatus();
  }
  file->made.set_evaluations(cover->evaluations);
  file->made.set_failed_evaluations(cover->failures);
  file->made.set_truncated(cover->end != CoverEnd::kCovered);
  file->made.set_interpolation_error(cover->interpolation_error);
  LogCover(work, place, *file, cover->primitives.size(), seconds);
  std::vector<FamilyCover> alone;
  alone.push_back({.family = 0, .primitives = std::move(cover->primitives)});
  MORTISE_ASSIGN_OR_RETURN(const PrimitiveIndex index, PrimitiveIndex::Build(std::move(alone)));
  MORTISE_ASSIGN_OR_RETURN(file->bytes,
                           IndexBytes(index, FormatOf(*work.descriptors[place]), kCoverVersion));
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
  const absl::StatusOr<std::shared_ptr<const SearchedTemplate>> compiled =
      templates.Get(family.template_(), family.template_revision(), origin, family.group());
  if (absl::IsNotFound(compiled.status()) || IsPassingFailure(compiled.status())) {
    return compiled.status();
  }
  std::optional<FamilyWork> work;
  if (compiled.ok()) {
    MORTISE_ASSIGN_OR_RETURN(work, WorkOf(task, **compiled));
  }
  for (int i = 0; i < task.covers_size(); ++i) {
    const v1::WantedCover& wanted = task.covers(i);
    CoverFile file;
    file.made.set_shape_descriptor(wanted.shape_descriptor());
    file.made.set_digest(wanted.digest());
    if (work) {
      MORTISE_RETURN_IF_ERROR(
          Fill(*work, static_cast<std::size_t>(i), wanted.delta(), stop, &file));
    } else {
      file.made.set_fault(std::string(compiled.status().message()));
    }
    MORTISE_RETURN_IF_ERROR(keep(std::move(file), i + 1 == task.covers_size()));
  }
  return absl::OkStatus();
}

}  // namespace mortise::retrieval
