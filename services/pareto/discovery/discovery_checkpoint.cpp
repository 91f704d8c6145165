// Checkpoints of a discovery as bytes.
#include <bit>
#include <cstring>

#include "absl/strings/str_cat.h"
#include "services/pareto/discovery/discovery_run.h"

namespace mortise::pareto {
namespace {

static_assert(std::endian::native == std::endian::little);

constexpr std::string_view kMagic = "MPC4";
// Of discoveries begun before: what they lack is what came later.
constexpr std::string_view kMagicWithoutDeviations = "MPC3";
constexpr std::string_view kMagicWithoutConstraints = "MPC2";
constexpr std::string_view kMagicWithoutReasons = "MPC1";
constexpr std::uint64_t kSizeLimit = 1 << 24;
constexpr auto kLastCode = static_cast<std::int32_t>(absl::StatusCode::kUnauthenticated);

template <typename T>
void Append(std::string& bytes, T value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof(T));
}

void AppendDoubles(std::string& bytes, const double* values, Eigen::Index count) {
  bytes.append(reinterpret_cast<const char*>(values),
               static_cast<std::size_t>(count) * sizeof(double));
}

class Reader {
 public:
  explicit Reader(std::string_view bytes) : rest_(bytes) {}

  template <typename T>
  bool Read(T& value) {
    if (rest_.size() < sizeof(T)) return false;
    std::memcpy(&value, rest_.data(), sizeof(T));
    rest_.remove_prefix(sizeof(T));
    return true;
  }

  bool ReadDoubles(double* values, std::uint64_t count) {
    if (count > rest_.size() / sizeof(double)) return false;
    std::memcpy(values, rest_.data(), count * sizeof(double));
    rest_.remove_prefix(count * sizeof(double));
    return true;
  }

  // A vector with its length in front. False when fewer bytes are left than it claims.
  bool ReadVector(Eigen::VectorXd& vector) {
    std::uint64_t size = 0;
    if (!Read(size) || size > kSizeLimit || size > rest_.size() / sizeof(double)) return false;
    vector.resize(static_cast<Eigen::Index>(size));
    return ReadDoubles(vector.data(), size);
  }

  bool ReadText(std::string& text) {
    std::uint64_t size = 0;
    if (!Read(size) || size > rest_.size()) return false;
    text.assign(rest_.substr(0, size));
    rest_.remove_prefix(size);
    return true;
  }

  bool Skip(std::string_view expected) {
    if (rest_.substr(0, expected.size()) != expected) return false;
    rest_.remove_prefix(expected.size());
    return true;
  }

  bool AtEnd() const { return rest_.empty(); }

 private:
  std::string_view rest_;
};

void AppendVector(std::string& bytes, const Eigen::VectorXd& vector) {
  Append<std::uint64_t>(bytes, static_cast<std::uint64_t>(vector.size()));
  AppendDoubles(bytes, vector.data(), vector.size());
}

// The constant and the code of a failure.
bool ReadReason(Reader& reader, Evaluation& evaluation) {
  std::int32_t code = 0;
  if (!reader.Read(code) || code < 0 || code > kLastCode || !reader.ReadText(evaluation.reason)) {
    return false;
  }
  evaluation.code = static_cast<absl::StatusCode>(code);
  return true;
}

// A matrix with a column a parameter; empty where none was offered.
bool ReadJacobian(Reader& reader, Eigen::Index rows, Eigen::Index columns,
                  Eigen::MatrixXd& jacobian) {
  Eigen::VectorXd values;
  if (!reader.ReadVector(values)) return false;
  if (values.size() == 0) return true;
  if (values.size() != rows * columns) return false;
  jacobian = Eigen::Map<const Eigen::MatrixXd>(values.data(), rows, columns);
  return true;
}

bool ReadConstraints(Reader& reader, Evaluation& evaluation) {
  return reader.ReadVector(evaluation.constraints) &&
         ReadJacobian(reader, evaluation.constraints.size(), evaluation.x.size(),
                      evaluation.constraint_jacobian);
}

bool ReadResult(Reader& reader, std::string_view magic, std::int64_t& number,
                Evaluation& evaluation) {
  std::uint8_t evaluated = 0;
  if (!reader.Read(number) || !reader.Read(evaluated) || evaluated > 1 || number < 0 ||
      !reader.ReadVector(evaluation.x) || !reader.ReadVector(evaluation.metrics) ||
      !ReadJacobian(reader, evaluation.metrics.size(), evaluation.x.size(), evaluation.jacobian) ||
      !reader.ReadText(evaluation.message)) {
    return false;
  }
  evaluation.status = evaluated != 0 ? EvaluationStatus::kEvaluated : EvaluationStatus::kFailed;
  if (magic == kMagicWithoutReasons) return true;
  if (!ReadReason(reader, evaluation)) return false;
  if (magic == kMagicWithoutConstraints) return true;
  if (!ReadConstraints(reader, evaluation)) return false;
  return magic == kMagicWithoutDeviations || reader.ReadVector(evaluation.deviations);
}

// Which of the known ones it begins with; empty if it is none.
std::string_view ReadMagic(Reader& reader) {
  for (const std::string_view known :
       {kMagic, kMagicWithoutDeviations, kMagicWithoutConstraints, kMagicWithoutReasons}) {
    if (reader.Skip(known)) return known;
  }
  return {};
}

}  // namespace

std::string Serialize(const DiscoveryCheckpoint& checkpoint) {
  std::string bytes(kMagic);
  Append<std::uint64_t>(bytes, checkpoint.results.size());
  for (const auto& [number, evaluation] : checkpoint.results) {
    Append(bytes, number);
    Append<std::uint8_t>(bytes, evaluation.status == EvaluationStatus::kEvaluated ? 1 : 0);
    AppendVector(bytes, evaluation.x);
    AppendVector(bytes, evaluation.metrics);
    AppendVector(bytes, evaluation.jacobian.reshaped());
    Append<std::uint64_t>(bytes, evaluation.message.size());
    bytes += evaluation.message;
    Append(bytes, static_cast<std::int32_t>(evaluation.code));
    Append<std::uint64_t>(bytes, evaluation.reason.size());
    bytes += evaluation.reason;
    AppendVector(bytes, evaluation.constraints);
    AppendVector(bytes, evaluation.constraint_jacobian.reshaped());
    AppendVector(bytes, evaluation.deviations);
  }
  return bytes;
}

absl::StatusOr<DiscoveryCheckpoint> ParseCheckpoint(std::string_view bytes) {
  DiscoveryCheckpoint checkpoint;
  Reader reader(bytes);
  while (!reader.AtEnd()) {
    std::uint64_t count = 0;
    const std::string_view magic = ReadMagic(reader);
    if (magic.empty() || !reader.Read(count)) {
      return absl::DataLossError("not a checkpoint of a discovery");
    }
    for (std::uint64_t i = 0; i < count; ++i) {
      std::int64_t number = 0;
      Evaluation evaluation;
      if (!ReadResult(reader, magic, number, evaluation)) {
        return absl::DataLossError(absl::StrCat("result ", i, " of the checkpoint is damaged"));
      }
      checkpoint.results.insert_or_assign(number, std::move(evaluation));
    }
  }
  return checkpoint;
}

}  // namespace mortise::pareto
