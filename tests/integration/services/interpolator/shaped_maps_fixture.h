// What tests of maps with shapes ask.
#pragma once

#include <grpcpp/grpcpp.h>
#include <gtest/gtest.h>

#include <cstring>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "tests/integration/services/interpolator/interpolator_service_fixture.h"

namespace mortise::interpolator {

// Numbers of 32 bits.
template <typename Number>
std::vector<Number> NumbersOf(const std::string& bytes) {
  std::vector<Number> numbers(bytes.size() / sizeof(Number));
  std::memcpy(numbers.data(), bytes.data(), bytes.size());
  return numbers;
}

// A stream of FollowMapShape.
class Following {
 public:
  explicit Following(v1::InterpolatorService::Stub& stub)
      : context_(std::make_unique<grpc::ClientContext>()),
        stream_(stub.FollowMapShape(context_.get())) {}

  void Begin(const std::string& map) {
    v1::FollowMapShapeRequest request;
    request.mutable_begin()->set_name(map);
    stream_->Write(request);
  }
  void To(std::int64_t sequence, double x, double y) {
    v1::FollowMapShapeRequest request;
    request.mutable_to()->set_sequence(sequence);
    request.mutable_to()->add_point(x);
    request.mutable_to()->add_point(y);
    stream_->Write(request);
  }
  // Nothing more comes.
  void End() { stream_->WritesDone(); }

  v1::MapShape Next() {
    v1::MapShape shape;
    EXPECT_TRUE(stream_->Read(&shape));
    return shape;
  }
  // Reads what is left.
  grpc::Status Finish() {
    v1::MapShape shape;
    while (stream_->Read(&shape)) {
    }
    return stream_->Finish();
  }

 private:
  std::unique_ptr<grpc::ClientContext> context_;
  std::unique_ptr<grpc::ClientReaderWriter<v1::FollowMapShapeRequest, v1::MapShape>> stream_;
};

class ShapedMapsTest : public InterpolatorServiceTest {
 protected:
  // Of the bars that the evaluator has files of.
  static v1::BuildMapRequest ShapeRequest(int evaluations) {
    v1::BuildMapRequest request = Request(evaluations);
    v1::MapSpecification& specification = *request.mutable_specification();
    specification.mutable_metrics()->RemoveLast();
    v1::MapSpecification::ShapeChoice& shape = *specification.mutable_shape();
    shape.set_geometry(v1::TETRAHEDRA);
    shape.add_fields()->set_name("stress");
    shape.add_fields()->set_name("heat");
    return request;
  }

  static v1::EvaluateMapShapeRequest At(const std::string& map, double x, double y,
                                        v1::GeometryKind geometry = v1::SURFACE) {
    v1::EvaluateMapShapeRequest request;
    request.set_name(map);
    request.add_point(x);
    request.add_point(y);
    request.set_geometry(geometry);
    return request;
  }

  grpc::Status AskShape(const v1::EvaluateMapShapeRequest& request, v1::MapShape& shape) {
    grpc::ClientContext context;
    return maps_->EvaluateMapShape(&context, request, &shape);
  }
  v1::MapShape Shape(const v1::EvaluateMapShapeRequest& request) {
    v1::MapShape shape;
    const grpc::Status status = AskShape(request, shape);
    EXPECT_TRUE(status.ok()) << status.error_message();
    return shape;
  }

  Following Open() { return Following(*maps_); }
  Following Follow(const std::string& map) {
    Following following(*maps_);
    following.Begin(map);
    return following;
  }
};

}  // namespace mortise::interpolator
