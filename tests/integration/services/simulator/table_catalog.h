// A catalog that serves the collection's table on loopback, from the test's own process.
#pragma once

#include <grpcpp/grpcpp.h>

#include <atomic>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <string>

#include "common/files/collection.h"
#include "common/files/template_codec.h"
#include "mortise/v1/catalog.grpc.pb.h"

namespace mortise::simulator {

class TableCatalog final : public v1::CatalogService::Service {
 public:
  TableCatalog() {
    const parametric::Collection collection =
        parametric::ReadCollection(std::filesystem::path(SourceFolder()) / "collection").value();
    bundle_ = parametric::ToProto(parametric::BundleOf(collection, "templates/table").value());
    bundle_.mutable_template_()->set_revision(1);
    bundle_.mutable_template_()->set_digest(parametric::TemplateDigest(bundle_.template_()));
    grpc::ServerBuilder builder;
    int port = 0;
    builder.AddListeningPort("127.0.0.1:0", grpc::InsecureServerCredentials(), &port);
    builder.RegisterService(this);
    server_ = builder.BuildAndStart();
    address_ = "127.0.0.1:" + std::to_string(port);
  }
  ~TableCatalog() override { server_->Shutdown(); }

  const std::string& address() const { return address_; }
  const v1::Template& table() const { return bundle_.template_(); }

  v1::Material Material(const std::string& name) const {
    for (const v1::Material& material : bundle_.materials()) {
      if (material.name() == name) return material;
    }
    return {};
  }

  grpc::Status GetMaterial(grpc::ServerContext*, const v1::GetMaterialRequest* request,
                           v1::Material* response) override {
    *response = Material(request->name());
    if (!response->name().empty()) return grpc::Status::OK;
    return {grpc::StatusCode::NOT_FOUND, "no such material: " + request->name()};
  }

  grpc::Status GetTemplateBundle(grpc::ServerContext*, const v1::GetTemplateBundleRequest* request,
                                 v1::TemplateBundle* response) override {
    ++asked;
    if (request->name() != "templates/table" || request->revision() > 1) {
      return {grpc::StatusCode::NOT_FOUND, "no such template revision: " + request->name()};
    }
    *response = bundle_;
    return grpc::Status::OK;
  }

  std::atomic<int> asked = 0;  // for bundles

 private:
  static std::string SourceFolder() {
    const char* folder = std::getenv("MORTISE_SOURCE_DIR");
    return folder == nullptr ? "." : folder;
  }

  v1::TemplateBundle bundle_;
  std::unique_ptr<grpc::Server> server_;
  std::string address_;
};

}  // namespace mortise::simulator
