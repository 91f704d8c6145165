#include "tests/e2e/request_mutations.h"

#include <google/protobuf/descriptor.h>
#include <google/protobuf/message.h>
#include <google/protobuf/stubs/logging.h>

#include <limits>
#include <random>
#include <set>

#include "absl/strings/str_cat.h"

namespace mortise::e2e {
namespace {

using google::protobuf::Descriptor;
using google::protobuf::FieldDescriptor;
using google::protobuf::Message;
using google::protobuf::Reflection;

constexpr int kDeepest = 6;
constexpr std::size_t kLongText = 10'000;
constexpr int kManyElements = 20'000;

// Numbers that may be anything, and what the service sets itself and ignores in requests.
const std::set<std::string>& AnyNumber() {
  static const std::set<std::string> names = {
      "mortise.v1.Vector2.u",
      "mortise.v1.Vector2.v",
      "mortise.v1.Vector3.x",
      "mortise.v1.Vector3.y",
      "mortise.v1.Vector3.z",
      "mortise.v1.LoadVector.x",
      "mortise.v1.LoadVector.y",
      "mortise.v1.LoadVector.z",
      "mortise.v1.Connection.priority",
      "mortise.v1.DiscoverySpecification.seed",
      "mortise.v1.MapSpecification.seed",
      "mortise.v1.OptimizeMapRequest.Limit.minimum",
      "mortise.v1.OptimizeMapRequest.seed",
      "mortise.v1.VerifyMapRequest.seed",
      "mortise.v1.Material.revision",
      "mortise.v1.Material.poissons_ratio",
      "mortise.v1.Template.revision",
      "mortise.v1.Template.placed_template_revision",
      "mortise.v1.HeightField.datum",
      "mortise.v1.HeightGrid.x",
      "mortise.v1.HeightGrid.y",
      "mortise.v1.HeightGrid.heights",
      "mortise.v1.HeightTriangles.vertices",
      "mortise.v1.Assembly.revision",
      "mortise.v1.Parameter.minimum",
      "mortise.v1.EvaluationResult.index",
      "mortise.v1.Metric.value",
      "mortise.v1.DesignPoint.parameters",
      "mortise.v1.DiscoverySpecification.Bound.minimum",
      "mortise.v1.DiscoverySpecification.Constraint.minimum",
      "mortise.v1.FrontLimit.minimum",
      "mortise.v1.ProminentPlane.position",
      "mortise.v1.RestPose.amount",
      "mortise.v1.Joint.lower",
      "mortise.v1.Joint.upper",
      "mortise.v1.MeasureDemand.value",
      "mortise.v1.AdjustAssemblyRequest.q",
      "mortise.v1.DragControlRequest.value",
      "mortise.v1.PreviewDragRequest.value",
      "mortise.v1.PreviewDragRequest.since_value",
      "mortise.v1.EvaluateAssemblyRequest.Point.q",
      "mortise.v1.ExportAssemblyRequest.q",
      "mortise.v1.MaterialValues.thermal_expansion",
      "mortise.v1.OrthotropicValues.thermal_expansion",
      "mortise.v1.PrescribedDisplacement.x",
      "mortise.v1.PrescribedDisplacement.y",
      "mortise.v1.PrescribedDisplacement.z",
      "mortise.v1.GroupPressure.pressure",
      "mortise.v1.LoadCombination.Term.factor",
      "mortise.v1.MeshHeat.reference_temperature",
      "mortise.v1.DesignSpace.DesignParameter.minimum",
      "mortise.v1.GroupTemperature.temperature",
      "mortise.v1.GroupFlux.flux",
      "mortise.v1.GroupConvection.ambient",
      "mortise.v1.GroupSource.power",
  };
  return names;
}

// Texts that name something, beyond those called `name`.
bool NamesSomething(const FieldDescriptor* field) {
  static const std::set<std::string> names = {
      "name",      "parent",    "template",  "plan",     "subject",    "item",   "material",
      "part",      "face",      "stream",    "streams",  "other_part", "metric", "metrics",
      "service",   "file_name", "bridge",    "machine",  "work_order", "sha256", "parameter",
      "evaluator", "shape",     "rest_pose", "load_case"};
  return names.count(field->name()) != 0 || field->name().ends_with("_name");
}

// Names that may be new: of what the request makes, or has lost.
bool GivesName(const FieldDescriptor* field) {
  static const std::set<std::string> names = {"mortise.v1.Material.name",
                                              "mortise.v1.Item.name",
                                              "mortise.v1.Template.name",
                                              "mortise.v1.Assembly.name",
                                              "mortise.v1.AssemblyAnnotations.name",
                                              "mortise.v1.Connection.name",
                                              "mortise.v1.BoundaryCondition.name",
                                              "mortise.v1.BoundaryCondition.load_case",
                                              "mortise.v1.BridgeMessage.Hello.bridge",
                                              "mortise.v1.Machine.name",
                                              "mortise.v1.Evaluator.name",
                                              "mortise.v1.LeaseTasksRequest.evaluator",
                                              "mortise.v1.ListAnalysesRequest.subject",
                                              "mortise.v1.ListFrontsRequest.subject",
                                              "mortise.v1.ListMapsRequest.subject",
                                              "mortise.v1.TaskAttempt.name",
                                              "mortise.v1.ListTasksRequest.evaluator",
                                              "mortise.v1.ListOperationsRequest.subject",
                                              "mortise.v1.ListPlansRequest.subject",
                                              "mortise.v1.ListWorkOrdersRequest.subject",
                                              "mortise.v1.GetQueueStatusRequest.evaluator"};
  return names.count(field->full_name()) != 0;
}

// Names of what is drawn, within one assembly, and of files: any short text.
bool IsLabel(const FieldDescriptor* field) {
  static const std::set<std::string> names = {"mortise.v1.AssemblyPart.name",
                                              "mortise.v1.AssemblyGroup.name",
                                              "mortise.v1.Joint.name",
                                              "mortise.v1.RestPose.name",
                                              "mortise.v1.ProminentPlane.name",
                                              "mortise.v1.MeshLoadCase.name",
                                              "mortise.v1.LoadCombination.name",
                                              "mortise.v1.MeshProbe.name",
                                              "mortise.v1.ImportAssemblyMeshRequest.file_name",
                                              "mortise.v1.QueryMesh.file_name"};
  return names.count(field->full_name()) != 0;
}

// Whether a method reads `field` of the message that `holder` holds: those that change external ids
// and labels read nothing else of the resource, but for the title of a model.
bool IsLookedAt(const FieldDescriptor* holder, const FieldDescriptor* field) {
  static const std::set<std::string> resources = {
      "mortise.v1.UpdatePlanRequest.plan", "mortise.v1.UpdateWorkOrderRequest.work_order",
      "mortise.v1.UpdateWebhookRequest.webhook", "mortise.v1.UpdateModelRequest.model"};
  static const std::set<std::string> names = {"name", "external_ids", "labels"};
  return resources.count(holder->full_name()) == 0 || names.count(field->name()) != 0 ||
         field->full_name() == "mortise.v1.Model.title";
}

bool IsExpression(const FieldDescriptor* field) {
  const std::string& owner = field->containing_type()->full_name();
  return owner == "mortise.v1.Extent" || owner == "mortise.v1.OutlinePoint" ||
         field->full_name() == "mortise.v1.BoundaryCondition.components" ||
         field->full_name() == "mortise.v1.Template.reference_temperature";
}

// Where a field is in the tree of messages: the fields that lead to it, itself last.
using Route = std::vector<const FieldDescriptor*>;

std::string PathOf(const Route& route) {
  std::string path;
  for (const FieldDescriptor* field : route) {
    absl::StrAppend(&path, path.empty() ? "" : ".", field->name(),
                    field->is_repeated() ? "[0]" : "");
  }
  return path;
}

// The message that holds the route's last field; what leads there is made where it is missing.
Message* Holder(Message* root, const Route& route) {
  Message* at = root;
  for (std::size_t i = 0; i + 1 < route.size(); ++i) {
    const Reflection& reflection = *at->GetReflection();
    if (!route[i]->is_repeated()) {
      at = reflection.MutableMessage(at, route[i]);
    } else if (reflection.FieldSize(*at, route[i]) == 0) {
      at = reflection.AddMessage(at, route[i]);
    } else {
      at = reflection.MutableRepeatedMessage(at, route[i], 0);
    }
  }
  return at;
}

// Invalid UTF-8 is written all the same, with a complaint on standard error.
std::string Serialized(const Message& message) {
  const google::protobuf::LogSilencer silence;
  return message.SerializePartialAsString();
}

// What is made of a good request.
enum class Sort { kFaults, kLargeNumbers };

class Spoiler {
 public:
  Spoiler(const Message& good, Sort sort) : good_(good), sort_(sort) {
    Visit(good.GetDescriptor());
  }

  std::vector<BadRequest> Take() { return std::move(requests_); }

 private:
  void Visit(const Descriptor* type) {
    if (route_.size() >= kDeepest) return;
    for (int i = 0; i < type->field_count(); ++i) {
      const FieldDescriptor* field = type->field(i);
      if (!route_.empty() && !IsLookedAt(route_.back(), field)) continue;
      route_.push_back(field);
      Spoil(field);
      route_.pop_back();
    }
  }

  void Spoil(const FieldDescriptor* field) {
    if (sort_ == Sort::kLargeNumbers) return Enlarge(field);
    if (field->is_repeated() && field->name() != "analysis_lacks") SpoilByCount(field);
    switch (field->cpp_type()) {
      case FieldDescriptor::CPPTYPE_DOUBLE:
        return SpoilDouble(field);
      case FieldDescriptor::CPPTYPE_ENUM:
        return Add("an unknown enum number", Verdict::kPath,
                   [&](Message* at) { SetEnum(at, field); });
      case FieldDescriptor::CPPTYPE_INT32:
      case FieldDescriptor::CPPTYPE_INT64:
        return SpoilInteger(field);
      case FieldDescriptor::CPPTYPE_STRING:
        if (field->type() == FieldDescriptor::TYPE_STRING) SpoilText(field);
        return;
      case FieldDescriptor::CPPTYPE_MESSAGE:
        return SpoilMessage(field);
      default:
        return;
    }
  }

  void SpoilMessage(const FieldDescriptor* field) {
    const std::string& type = field->message_type()->full_name();
    // Times are set by the services; Any is not looked into.
    if (type == "google.protobuf.Timestamp" || type == "google.protobuf.Any") return;
    if (type != "google.protobuf.FieldMask") return Visit(field->message_type());
    if (sort_ == Sort::kLargeNumbers) return;
    Add("an unknown path", Verdict::kField, [&](Message* at) {
      Message* mask = at->GetReflection()->MutableMessage(at, field);
      mask->GetReflection()->AddString(mask, mask->GetDescriptor()->FindFieldByName("paths"),
                                       "no.such.field");
    });
  }

  void Enlarge(const FieldDescriptor* field) {
    if (field->cpp_type() == FieldDescriptor::CPPTYPE_MESSAGE) return SpoilMessage(field);
    if (field->cpp_type() != FieldDescriptor::CPPTYPE_DOUBLE) return;
    for (const double number : {30e3, 1e300}) AddDouble(number, Verdict::kAnswered);
  }

  void SpoilDouble(const FieldDescriptor* field) {
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    // Heights of a grid are not known where they are no numbers.
    if (field->full_name() != "mortise.v1.HeightGrid.heights") {
      AddDouble(std::numeric_limits<double>::quiet_NaN(), Verdict::kPath);
    }
    for (const double number : {kInfinity, -kInfinity}) AddDouble(number, Verdict::kPath);
    if (AnyNumber().count(field->full_name()) == 0) AddDouble(-1.5, Verdict::kField);
  }

  void SpoilInteger(const FieldDescriptor* field) {
    const auto set = [&](int64_t value) {
      return [field, value](Message* at) {
        const Reflection& reflection = *at->GetReflection();
        const bool is_long = field->cpp_type() == FieldDescriptor::CPPTYPE_INT64;
        const auto narrow = static_cast<int32_t>(value);
        if (!field->is_repeated()) {
          return is_long ? reflection.SetInt64(at, field, value)
                         : reflection.SetInt32(at, field, narrow);
        }
        const bool is_empty = reflection.FieldSize(*at, field) == 0;
        if (is_long) {
          return is_empty ? reflection.AddInt64(at, field, value)
                          : reflection.SetRepeatedInt64(at, field, 0, value);
        }
        return is_empty ? reflection.AddInt32(at, field, narrow)
                        : reflection.SetRepeatedInt32(at, field, 0, narrow);
      };
    };
    if (AnyNumber().count(field->full_name()) != 0) return;
    // Only a request that knows a revision has one to be stale.
    const bool is_item = field->full_name() == "mortise.v1.Item.revision";
    if (is_item && FirstInteger(field) == 0) return;
    // After the present revision there is nothing yet.
    const bool is_revision =
        field->name().ends_with("revision") && field->name() != "after_revision";
    // A sequence may be read from before its beginning: from -1 on, only what is new.
    const int64_t negative = field->name() == "after_number" ? -2 : -1;
    Add("a negative number", is_revision ? Verdict::kRefused : Verdict::kField, set(negative));
    if (is_revision) {
      Add("a stale revision", Verdict::kRefused, set(999'999));
    } else if (field->cpp_type() == FieldDescriptor::CPPTYPE_INT32 && field->name() != "attempt") {
      Add("the largest number", Verdict::kField, set(std::numeric_limits<int32_t>::max()));
    }
  }

  void SpoilText(const FieldDescriptor* field) {
    AddText("invalid UTF-8", Verdict::kUnreadable, "caf\xE9\xFF");
    if (NamesSomething(field)) SpoilName(field);
    if (IsExpression(field)) {
      AddText("a parameter that is not there", Verdict::kField, "no_such_parameter");
      AddText("a division by zero", Verdict::kField, "1 / 0");
      AddText("a number past all numbers", Verdict::kField, "1e999");
      AddText("deep nesting", Verdict::kField, std::string(kLongText, '('));
      AddText("a NUL", Verdict::kField, std::string("0\0 + 1", 6));
    }
    if (field->name() == "page_token") {
      AddText("garbage", Verdict::kField, "no such token!");
      AddText("a name", Verdict::kField, "oak");
      AddText("a NUL", Verdict::kField, std::string("a\0b", 3));
      AddText("a long text", Verdict::kField, std::string(kLongText, 'a'));
    }
    if (field->name() == "request_id") {
      AddText("nothing", Verdict::kField, "");
      AddText("a line break", Verdict::kField, "a\nb");
      AddText("a NUL", Verdict::kField, std::string("a\0b", 3));
      AddText("a long text", Verdict::kField, std::string(kLongText, 'a'));
    }
    if (field->name() == "url" || field->name() == "supplier_url") {
      AddText("a script", Verdict::kField, "javascript:alert(1)");
    }
    if (field->name() == "price_date") AddText("no date", Verdict::kField, "2026-13-01");
    if (field->name() == "currency") AddText("no currency", Verdict::kField, "money");
  }

  void SpoilName(const FieldDescriptor* field) {
    const std::string good = FirstText(field);
    const std::string collection = good.substr(0, good.find('/') + 1);
    if (!GivesName(field) && !IsLabel(field)) {
      AddText("an unknown name", Verdict::kRefused, collection + "not-there");
    }
    if (!IsLabel(field)) {
      AddText("a malformed name", Verdict::kRefused, collection + "No such/Thing!");
      AddText("a path upwards", Verdict::kRefused, collection + "../../etc/passwd");
    }
    AddText("a long name", Verdict::kRefused, collection + std::string(kLongText, 'a'));
    std::string umlauts;
    while (umlauts.size() < kLongText) umlauts += "ü";
    AddText("a long name of umlauts", Verdict::kRefused, collection + umlauts);
    AddText("a name with a NUL", Verdict::kRefused, collection + std::string("a\0b", 3));
  }

  void SpoilByCount(const FieldDescriptor* field) {
    // A point that is none spoils only its own result.
    const bool refused = field->full_name() != "mortise.v1.DesignPoint.parameters";
    const Verdict verdict = refused ? Verdict::kRefused : Verdict::kAnswered;
    Add(absl::StrCat(kManyElements, " elements"), verdict, [&](Message* at) {
      const Reflection& reflection = *at->GetReflection();
      for (int i = reflection.FieldSize(*at, field); i < kManyElements; ++i) {
        switch (field->cpp_type()) {
          case FieldDescriptor::CPPTYPE_MESSAGE:
            reflection.AddMessage(at, field);
            break;
          case FieldDescriptor::CPPTYPE_STRING:
            reflection.AddString(at, field, "x");
            break;
          case FieldDescriptor::CPPTYPE_DOUBLE:
            reflection.AddDouble(at, field, 0.5);
            break;
          case FieldDescriptor::CPPTYPE_ENUM:
            reflection.AddEnumValue(at, field, 1);
            break;
          case FieldDescriptor::CPPTYPE_INT32:
            reflection.AddInt32(at, field, 7);
            break;
          default:
            return;
        }
      }
    });
  }

  static void SetEnum(Message* at, const FieldDescriptor* field) {
    constexpr int kUnknown = 9999;
    const Reflection& reflection = *at->GetReflection();
    if (field->is_repeated()) {
      if (reflection.FieldSize(*at, field) == 0)
        return reflection.AddEnumValue(at, field, kUnknown);
      return reflection.SetRepeatedEnumValue(at, field, 0, kUnknown);
    }
    reflection.SetEnumValue(at, field, kUnknown);
  }

  int64_t FirstInteger(const FieldDescriptor* field) const {
    const std::unique_ptr<Message> copy(good_.New());
    copy->CopyFrom(good_);
    const Message& at = *Holder(copy.get(), route_);
    return at.GetReflection()->GetInt64(at, field);
  }

  // What the good request has where the route ends.
  std::string FirstText(const FieldDescriptor* field) const {
    const std::unique_ptr<Message> copy(good_.New());
    copy->CopyFrom(good_);
    const Message& at = *Holder(copy.get(), route_);
    const Reflection& reflection = *at.GetReflection();
    if (!field->is_repeated()) return reflection.GetString(at, field);
    return reflection.FieldSize(at, field) == 0 ? "" : reflection.GetRepeatedString(at, field, 0);
  }

  void AddDouble(double number, Verdict verdict) {
    const FieldDescriptor* field = route_.back();
    Add(absl::StrCat(number), verdict, [&](Message* at) {
      const Reflection& reflection = *at->GetReflection();
      if (!field->is_repeated()) return reflection.SetDouble(at, field, number);
      if (reflection.FieldSize(*at, field) == 0) return reflection.AddDouble(at, field, number);
      reflection.SetRepeatedDouble(at, field, 0, number);
    });
  }

  void AddText(const std::string& what, Verdict verdict, const std::string& text) {
    const FieldDescriptor* field = route_.back();
    Add(what, verdict, [&](Message* at) {
      const Reflection& reflection = *at->GetReflection();
      if (!field->is_repeated()) return reflection.SetString(at, field, text);
      if (reflection.FieldSize(*at, field) == 0) return reflection.AddString(at, field, text);
      reflection.SetRepeatedString(at, field, 0, text);
    });
  }

  template <class Change>
  void Add(const std::string& what, Verdict verdict, const Change& change) {
    const std::unique_ptr<Message> spoilt(good_.New());
    spoilt->CopyFrom(good_);
    change(Holder(spoilt.get(), route_));
    if (verdict == Verdict::kField && IsElsewhere()) verdict = Verdict::kRefused;
    // One that is answered well would be the answer to the next under its id, too.
    const FieldDescriptor* id = spoilt->GetDescriptor()->FindFieldByName("request_id");
    if (id != nullptr && sort_ == Sort::kLargeNumbers) {
      spoilt->GetReflection()->SetString(
          spoilt.get(), id,
          absl::StrCat(spoilt->GetReflection()->GetString(*spoilt, id), "-", requests_.size()));
    }
    requests_.push_back({what, PathOf(route_), verdict, Serialized(*spoilt)});
  }

  // Whether the good request has another member of a oneof than the one that leads here: then more
  // is wrong than this field.
  bool IsElsewhere() const {
    const std::unique_ptr<Message> copy(good_.New());
    copy->CopyFrom(good_);
    for (std::size_t i = 0; i < route_.size(); ++i) {
      const auto* oneof = route_[i]->real_containing_oneof();
      if (oneof == nullptr) continue;
      const Message& at = *Holder(copy.get(), Route(route_.begin(), route_.begin() + i + 1));
      if (!at.GetReflection()->HasField(at, route_[i])) return true;
    }
    return false;
  }

  const Message& good_;
  const Sort sort_;
  Route route_;
  std::vector<BadRequest> requests_;
};

bool IsMessage(const Message& type, const std::string& bytes) {
  const google::protobuf::LogSilencer silence;
  const std::unique_ptr<Message> parsed(type.New());
  return parsed->ParsePartialFromString(bytes);
}

}  // namespace

std::vector<BadRequest> RandomBytes(const Message& type, unsigned seed, int count) {
  std::mt19937 random(seed);
  std::vector<BadRequest> requests;
  for (int i = 0; i < count; ++i) {
    std::string bytes(random() % 401, '\0');
    for (char& byte : bytes) byte = static_cast<char>(random());
    if (IsMessage(type, bytes)) continue;
    requests.push_back({absl::StrCat("random bytes ", i), "", Verdict::kUnreadable, bytes});
  }
  return requests;
}

std::vector<BadRequest> Truncations(const Message& good, int count) {
  const std::string whole = Serialized(good);
  std::vector<BadRequest> requests;
  for (int i = 1; i < count; ++i) {
    const std::string bytes = whole.substr(0, whole.size() * static_cast<std::size_t>(i) / count);
    if (IsMessage(good, bytes)) continue;
    requests.push_back(
        {absl::StrCat("cut off after ", bytes.size(), " bytes"), "", Verdict::kUnreadable, bytes});
  }
  return requests;
}

std::vector<BadRequest> SpoiltFields(const Message& good) {
  return Spoiler(good, Sort::kFaults).Take();
}

std::vector<BadRequest> LargeNumbers(const Message& good) {
  return Spoiler(good, Sort::kLargeNumbers).Take();
}

}  // namespace mortise::e2e
