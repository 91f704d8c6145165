#include "services/composer/catalog/shape_imports.h"

#include <grpcpp/grpcpp.h>

#include <map>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "common/assembly/codec/shape_codec.h"
#include "common/base/digest.h"
#include "common/base/errors.h"
#include "common/cad/step/step_writer.h"
#include "common/cad/stretch/solid_shape.h"
#include "mortise/v1/catalog.grpc.pb.h"

namespace mortise::composer {
namespace {

using Stub = v1::CatalogService::Stub;

constexpr double kMillimetres = 1000;  // in a metre; the unit of STL

// The triangles as text, which keeps more digits than binary STL.
std::string StlOf(const mesh::DrawnShape& shape) {
  const mesh::SurfaceMesh surface = mesh::SurfaceIn(shape, mesh::BoxStretch(shape.size));
  std::string text = "solid shape\n";
  for (Eigen::Index t = 0; t < surface.triangles.cols(); ++t) {
    text += "facet normal 0 0 0\nouter loop\n";
    for (const int corner : surface.triangles.col(t)) {
      const Eigen::Vector3d at = kMillimetres * (surface.vertices.col(corner) + shape.size / 2);
      absl::StrAppendFormat(&text, "vertex %.17g %.17g %.17g\n", at.x(), at.y(), at.z());
    }
    text += "endloop\nendfacet\n";
  }
  return text + "endsolid shape\n";
}

absl::StatusOr<bool> IsStored(Stub& catalog, const rpc::Origin& caller, const std::string& name) {
  v1::GetShapeRequest request;
  request.set_name(name);
  const absl::Status found = rpc::CallUnary(catalog, &Stub::GetShape, request, caller).status();
  if (absl::IsNotFound(found)) return false;
  MORTISE_RETURN_IF_ERROR(found);
  return true;
}

absl::StatusOr<std::string> Import(Stub& catalog, const rpc::Origin& caller,
                                   const std::string& request_id, const mesh::DrawnShape& shape) {
  MORTISE_ASSIGN_OR_RETURN(v1::ImportShapeRequest request, FileOfShape(shape));
  request.set_request_id(Sha256Hex(absl::StrCat(request_id, "\n", shape.name)));
  MORTISE_ASSIGN_OR_RETURN(const v1::Shape imported,
                           rpc::CallUnary(catalog, &Stub::ImportShape, request, caller));
  return imported.name();
}

}  // namespace

absl::StatusOr<v1::ImportShapeRequest> FileOfShape(const mesh::DrawnShape& shape) {
  if (!shape.is_solid) {
    return PreconditionFailed("SHAPE_NOT_SOLID",
                              "what is only a surface cannot be stored turned: its mesh is not the "
                              "boundary of one solid");
  }
  v1::ImportShapeRequest request;
  if (shape.brep.empty()) {
    request.set_format(v1::ImportShapeRequest::STL);
    request.set_file(StlOf(shape));
    return request;
  }
  MORTISE_ASSIGN_OR_RETURN(cad::Solid solid,
                           cad::SolidOfShape(shape, mesh::BoxStretch(shape.size), "shape"));
  request.set_format(v1::ImportShapeRequest::STEP);
  MORTISE_ASSIGN_OR_RETURN(*request.mutable_file(),
                           cad::WriteStep("shape", {cad::AssemblyPart{std::move(solid)}}));
  return request;
}

absl::Status ImportShapes(const std::shared_ptr<grpc::Channel>& catalog, const rpc::Origin& caller,
                          const std::string& request_id, v1::AssemblyBundle* bundle) {
  const auto stub = v1::CatalogService::NewStub(catalog);
  MORTISE_ASSIGN_OR_RETURN(const parametric::ShapesByName shapes,
                           parametric::FromProto(bundle->shapes()));
  std::map<std::string, std::string> names;  // in the catalog, by those of the model
  for (v1::AssemblyPart& part : *bundle->mutable_assembly()->mutable_parts()) {
    if (part.shape().empty()) continue;
    const auto [name, is_new] = names.try_emplace(part.shape(), part.shape());
    if (is_new) {
      MORTISE_ASSIGN_OR_RETURN(const bool is_stored, IsStored(*stub, caller, part.shape()));
      if (!is_stored) {
        const auto shape = shapes.find(part.shape());
        if (shape == shapes.end()) {
          return absl::InternalError(absl::StrCat("a drawing lacks ", part.shape()));
        }
        MORTISE_ASSIGN_OR_RETURN(name->second, Import(*stub, caller, request_id, *shape->second));
      }
    }
    part.set_shape(name->second);
  }
  return absl::OkStatus();
}

}  // namespace mortise::composer
