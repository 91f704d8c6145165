// A catalog that knows a table, with a drawn leg too, and a rack, served on loopback by the test
// itself.
#pragma once

#include <grpcpp/grpcpp.h>

#include <memory>
#include <mutex>
#include <string>

#include "common/files/template_codec.h"
#include "mortise/v1/catalog.grpc.pb.h"
#include "services/fabplanner/documents/part_mesh.h"
#include "tests/unit/services/fabplanner/example_table.h"

namespace mortise::fabplanner {

class FakeCatalog final : public v1::CatalogService::Service {
 public:
  FakeCatalog() {
    grpc::ServerBuilder builder;
    int port = 0;
    builder.AddListeningPort("127.0.0.1:0", grpc::InsecureServerCredentials(), &port);
    builder.RegisterService(this);
    server_ = builder.BuildAndStart();
    address_ = "127.0.0.1:" + std::to_string(port);
  }
  ~FakeCatalog() override { server_->Shutdown(); }

  const std::string& address() const { return address_; }

  // Changes what later calls see.
  void SetItems(const Items& items) {
    std::lock_guard lock(mutex_);
    items_ = items;
  }

  // From now on STEP files cannot be made.
  void BreakStep() {
    std::lock_guard lock(mutex_);
    breaks_step_ = true;
  }

  // Designs do not fit into one message from now on.
  void OutgrowMessages() {
    std::lock_guard lock(mutex_);
    outgrows_messages_ = true;
  }

  grpc::Status EvaluateTemplate(grpc::ServerContext*, const v1::EvaluateTemplateRequest* request,
                                v1::EvaluatedDesign* response) override {
    {
      std::lock_guard lock(mutex_);
      if (outgrows_messages_) return {grpc::StatusCode::RESOURCE_EXHAUSTED, "too large"};
    }
    return Evaluate(request->name(), response);
  }

  static grpc::Status Evaluate(const std::string& name, v1::EvaluatedDesign* response) {
    const bool drawn = name == "templates/drawn";      // a leg of no item
    const bool screwed = name == "templates/screwed";  // held by screws that are parts
    if (name != "templates/table" && !drawn && !screwed) {
      return {grpc::StatusCode::NOT_FOUND, "no template " + name};
    }
    const Design table = screwed ? ExampleRack() : ExampleTable();
    parametric::EvaluatedDesign design;
    design.template_name = "templates/table";
    design.template_revision = 3;
    design.parameters = {{"length", 1.2}};
    for (const Part& part : table.parts) design.parts.push_back(Evaluated(part));
    if (drawn) MakeFaceted(table.parts[0], &design.parts[0]);
    for (const Peg& peg : table.pegs) {
      design.connectors.push_back({peg.connection, peg.item, peg.part, peg.other_part, peg.position,
                                   peg.direction, peg.diameter, peg.length, peg.depth_in_part,
                                   peg.priority});
    }
    *response = parametric::ToProto(design);
    return grpc::Status::OK;
  }

  grpc::Status GetTemplateBundle(grpc::ServerContext*, const v1::GetTemplateBundleRequest* request,
                                 v1::TemplateBundle* response) override {
    if (request->revision() != 3) return {grpc::StatusCode::NOT_FOUND, "only revision 3 is here"};
    parametric::TemplateBundle bundle;
    bundle.definition.name = "templates/table";
    bundle.definition.title = "Table";
    for (const Part& part : ExampleTable().parts) {
      bundle.definition.parts.push_back(
          {part.name, part.title, part.item, static_cast<parametric::Axis>(part.length_axis),
           static_cast<parametric::Axis>(part.thickness_axis), parametric::Box{}});
    }
    std::lock_guard lock(mutex_);
    for (const auto& [name, item] : items_) {
      parametric::Item stored;
      stored.name = name;
      stored.title = item.title;
      stored.kind = KindOf(item.kind);
      for (int axis = 0; axis < 3; ++axis) stored.dimensions[axis].size = item.size[axis];
      // What is cut is longer than its parts, and sheets are wider.
      const int resized = item.kind == ItemKind::kBoard ? 1 : item.kind == ItemKind::kSheet ? 2 : 0;
      for (int axis = 0; axis < resized; ++axis) {
        stored.dimensions[axis].process =
            resized == 1 ? parametric::Process::kChopSaw : parametric::Process::kJigsaw;
        stored.dimensions[axis].minimum = 0.04;
        stored.dimensions[axis].maximum = item.size[axis];
      }
      stored.price = {item.price.currency, item.price.amount};
      stored.price_basis = item.price_per_volume ? parametric::PriceBasis::kPerVolume
                                                 : parametric::PriceBasis::kPerPiece;
      stored.supplier = item.supplier;
      bundle.items.push_back(stored);
    }
    *response = parametric::ToProto(bundle);
    return grpc::Status::OK;
  }

  grpc::Status ExportDesign(grpc::ServerContext*, const v1::ExportDesignRequest* request,
                            grpc::ServerWriter<v1::Chunk>* writer) override {
    if (request->format() == v1::ExportDesignRequest::DESIGN) {
      v1::EvaluatedDesign design;
      const grpc::Status status = Evaluate(request->name(), &design);
      if (!status.ok()) return status;
      const std::string bytes = design.SerializeAsString();
      WriteAll({bytes.substr(0, bytes.size() / 2), bytes.substr(bytes.size() / 2)}, writer);
      return grpc::Status::OK;
    }
    if (request->format() != v1::ExportDesignRequest::STEP) {
      return {grpc::StatusCode::INVALID_ARGUMENT, "only STEP and designs are here"};
    }
    std::lock_guard lock(mutex_);
    if (breaks_step_) return {grpc::StatusCode::INTERNAL, "the kernel gave up"};
    WriteAll({"ISO-10303-21;", "END-ISO-10303-21;"}, writer);
    return grpc::Status::OK;
  }

 private:
  static void WriteAll(const std::vector<std::string>& pieces,
                       grpc::ServerWriter<v1::Chunk>* writer) {
    for (const std::string& piece : pieces) {
      v1::Chunk chunk;
      chunk.set_data(piece);
      writer->Write(chunk);
    }
  }

  static parametric::ItemKind KindOf(ItemKind kind) {
    switch (kind) {
      case ItemKind::kBoard:
        return parametric::ItemKind::kBoard;
      case ItemKind::kSheet:
        return parametric::ItemKind::kSheet;
      case ItemKind::kScrew:
        return parametric::ItemKind::kScrew;
      default:
        return parametric::ItemKind::kDowel;
    }
  }

  // The part as triangles, and of no item.
  static void MakeFaceted(const Part& part, parametric::EvaluatedPart* evaluated) {
    const render::Shape shape = PartShape(part, Eigen::Vector3d::Zero());
    evaluated->item.clear();
    evaluated->material = "materials/beech";
    evaluated->process = parametric::Process::kNone;
    evaluated->outline.resize(2, 0);
    evaluated->face_names.clear();
    parametric::FacetedShape& faceted = evaluated->faceted.emplace();
    faceted.surface = {shape.vertices, shape.triangles};
    faceted.triangle_face = Eigen::VectorXi::Zero(shape.triangles.cols());
    faceted.face_names = {{"surface"}};
  }

  static parametric::EvaluatedPart Evaluated(const Part& part) {
    parametric::EvaluatedPart evaluated;
    evaluated.name = part.name;
    evaluated.title = part.title;
    evaluated.item = part.item;
    evaluated.length_axis = static_cast<parametric::Axis>(part.length_axis);
    evaluated.thickness_axis = static_cast<parametric::Axis>(part.thickness_axis);
    evaluated.axis = static_cast<parametric::Axis>(part.extrusion_axis);
    evaluated.outline.resize(2, static_cast<Eigen::Index>(part.outline.size()));
    for (std::size_t i = 0; i < part.outline.size(); ++i) {
      evaluated.outline.col(static_cast<Eigen::Index>(i)) = part.outline[i];
    }
    evaluated.from = part.from;
    evaluated.to = part.to;
    evaluated.face_names = {"y_min", "x_max", "y_max", "x_min", "z_min", "z_max"};
    evaluated.minimum = BoundsOf(part).min();
    evaluated.maximum = BoundsOf(part).max();
    evaluated.size = part.size;
    evaluated.volume = part.size.prod();
    evaluated.mass = 500 * evaluated.volume;
    evaluated.connecting = part.connecting;
    evaluated.process = part.process == CutProcess::kJigsaw    ? parametric::Process::kJigsaw
                        : part.process == CutProcess::kChopSaw ? parametric::Process::kChopSaw
                                                               : parametric::Process::kNone;
    return evaluated;
  }

  std::unique_ptr<grpc::Server> server_;
  std::string address_;
  std::mutex mutex_;
  Items items_ = ExampleItems();    // guarded by mutex_
  bool breaks_step_ = false;        // guarded by mutex_
  bool outgrows_messages_ = false;  // guarded by mutex_
};

}  // namespace mortise::fabplanner
