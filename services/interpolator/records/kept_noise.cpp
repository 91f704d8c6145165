#include "services/interpolator/records/kept_noise.h"

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "services/interpolator/records/kept_records.h"
#include "stored_map.pb.h"

namespace mortise::interpolator {
namespace {

constexpr char kNoiseKind[] = "mapNoise";

absl::StatusOr<MeshNoise> Read(const store::Record& record) {
  const absl::Status unreadable =
      absl::DataLossError(absl::StrCat("the noise of ", record.key, " cannot be read"));
  stored::Noise noise;
  if (!noise.ParseFromString(record.payload) || noise.metric_count() < 0 ||
      noise.metrics_size() != noise.floors_size()) {
    return unreadable;
  }
  MeshNoise read;
  read.evaluations = noise.evaluations();
  read.metrics.resize(static_cast<std::size_t>(noise.metric_count()));
  for (int i = 0; i < noise.metrics_size(); ++i) {
    const auto metric = static_cast<std::size_t>(noise.metrics(i));
    if (metric >= read.metrics.size()) return unreadable;
    read.metrics[metric] = noise.floors(i);
  }
  if (noise.has_shape()) read.shape = noise.shape();
  for (const stored::Noise::OfField& field : noise.fields()) {
    read.fields.push_back({field.name(), field.load_case(), field.floor()});
  }
  return read;
}

}  // namespace

absl::StatusOr<std::optional<MeshNoise>> LoadNoise(store::Store& store, const std::string& id) {
  std::optional<MeshNoise> noise;
  MORTISE_RETURN_IF_ERROR(store.Read([&](store::ReadTransaction& transaction) {
    noise.reset();
    return VisitKept(transaction, kNoiseKind, KeptPrefix(id), /*with_payloads=*/true,
                     [&](const store::Record& record) -> absl::Status {
                       MORTISE_ASSIGN_OR_RETURN(noise, Read(record));
                       return absl::OkStatus();
                     });
  }));
  return noise;
}

absl::Status PutNoise(store::Transaction& transaction, const std::string& id,
                      const MeshNoise& noise) {
  stored::Noise to;
  to.set_evaluations(noise.evaluations);
  to.set_metric_count(static_cast<int>(noise.metrics.size()));
  for (std::size_t m = 0; m < noise.metrics.size(); ++m) {
    if (!noise.metrics[m]) continue;
    to.add_metrics(static_cast<int>(m));
    to.add_floors(*noise.metrics[m]);
  }
  if (noise.shape) to.set_shape(*noise.shape);
  for (const MeshNoise::OfField& field : noise.fields) {
    stored::Noise::OfField& each = *to.add_fields();
    each.set_name(field.name);
    each.set_load_case(field.load_case);
    each.set_floor(field.floor);
  }
  return transaction.Put(kNoiseKind, absl::StrCat(KeptPrefix(id), "noise"), to.SerializeAsString())
      .status();
}

absl::Status DropNoise(store::Transaction& transaction, const std::string& id) {
  return DropKept(transaction, kNoiseKind, id);
}

}  // namespace mortise::interpolator
