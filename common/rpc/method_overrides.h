// The overrides of a generated CallbackService, one line a method: a method's name is written once,
// its types come from the generated class, and what answers it is a plain function.
//
//   struct Catalog { store::Store* store; ... };  // what the methods stand on
//   absl::StatusOr<v1::Item> GetItem(const Catalog&, const rpc::Call&, const v1::GetItemRequest&);
//
//   class CatalogAdapter final : public v1::CatalogService::CallbackService {
//     using Contract = v1::CatalogService::CallbackService;
//     MORTISE_QUERY(GetItem, rpc::With(catalog_, methods::GetItem))
//     MORTISE_MUTATION(DeleteItem, rpc::With(catalog_, methods::DeleteItem))
//     Catalog catalog_;
//     rpc::Endpoint endpoint_;
//   };
//
// The class names its base `Contract` and has an Endpoint called `endpoint_` (handler.h), whose
// members of the same names say what the functions take and return. A method that the proto does
// not have, or whose function has other types, does not compile; one that mutates and is declared
// as a query, or the other way round, refuses every call.
//
// Include this in adapters (<name>_service.cpp) only: it brings gRPC.
#pragma once

#include <functional>

#include "common/rpc/handler.h"

namespace mortise::rpc {

template <class RequestType, class ResponseType>
struct MethodTypes {
  using Request = RequestType;
  using Response = ResponseType;
};

// Returns the types of a method of a generated class: of the overloads it has, the one for
// callbacks fits.
template <class Service, class Request, class Response>
MethodTypes<Request, Response> TypesOf(grpc::ServerUnaryReactor* (
    Service::*)(grpc::CallbackServerContext*, const Request*, Response*));
template <class Service, class Request, class Response>
MethodTypes<Request, Response> TypesOf(
    grpc::ServerWriteReactor<Response>* (Service::*)(grpc::CallbackServerContext*, const Request*));
template <class Service, class Request, class Response>
MethodTypes<Request, Response> TypesOf(
    grpc::ServerReadReactor<Request>* (Service::*)(grpc::CallbackServerContext*, Response*));
template <class Service, class Request, class Response>
MethodTypes<Request, Response> TypesOf(
    grpc::ServerBidiReactor<Request, Response>* (Service::*)(grpc::CallbackServerContext*));

// `function` with `state` as its first argument, which must outlive what is returned.
template <class State, class Function>
auto With(State& state, Function function) {
  return std::bind_front(function, std::ref(state));
}

}  // namespace mortise::rpc

#define MORTISE_REQUEST_OF(Method) decltype(::mortise::rpc::TypesOf(&Contract::Method))::Request
#define MORTISE_RESPONSE_OF(Method) decltype(::mortise::rpc::TypesOf(&Contract::Method))::Response

#define MORTISE_UNARY_METHOD(Member, Method, ...)                                     \
  grpc::ServerUnaryReactor* Method(grpc::CallbackServerContext* context,              \
                                   const MORTISE_REQUEST_OF(Method) * request,        \
                                   MORTISE_RESPONSE_OF(Method) * response) override { \
    return endpoint_.Member(#Method, context, request, response, __VA_ARGS__);        \
  }

// MORTISE_QUERY(Method, function [, explanation])
#define MORTISE_QUERY(Method, ...) MORTISE_UNARY_METHOD(Query, Method, __VA_ARGS__)

// MORTISE_ASYNC_QUERY(Method, start)
#define MORTISE_ASYNC_QUERY(Method, ...) MORTISE_UNARY_METHOD(AsyncQuery, Method, __VA_ARGS__)

// MORTISE_MUTATION(Method, function)
#define MORTISE_MUTATION(Method, ...) MORTISE_UNARY_METHOD(Mutation, Method, __VA_ARGS__)

// MORTISE_PREPARED_MUTATION(Method, prepare, function [, bad numbers])
#define MORTISE_PREPARED_MUTATION(Method, ...) \
  MORTISE_UNARY_METHOD(PreparedMutation, Method, __VA_ARGS__)

// MORTISE_SERVER_STREAM(Method, start [, options [, explanation]])
#define MORTISE_SERVER_STREAM(Method, ...)                                                         \
  grpc::ServerWriteReactor<MORTISE_RESPONSE_OF(Method)>* Method(                                   \
      grpc::CallbackServerContext* context, const MORTISE_REQUEST_OF(Method) * request) override { \
    return endpoint_.ServerStream<MORTISE_RESPONSE_OF(Method)>(#Method, context, request,          \
                                                               __VA_ARGS__);                       \
  }

// MORTISE_UPLOAD(Method, open)
#define MORTISE_UPLOAD(Method, ...)                                                            \
  grpc::ServerReadReactor<MORTISE_REQUEST_OF(Method)>* Method(                                 \
      grpc::CallbackServerContext* context, MORTISE_RESPONSE_OF(Method) * response) override { \
    return endpoint_.Upload<MORTISE_REQUEST_OF(Method), MORTISE_RESPONSE_OF(Method)>(          \
        #Method, context, response, __VA_ARGS__);                                              \
  }

// MORTISE_BIDI(Method, open [, options])
#define MORTISE_BIDI(Method, ...)                                                           \
  grpc::ServerBidiReactor<MORTISE_REQUEST_OF(Method), MORTISE_RESPONSE_OF(Method)>* Method( \
      grpc::CallbackServerContext* context) override {                                      \
    return endpoint_.Bidi<MORTISE_REQUEST_OF(Method), MORTISE_RESPONSE_OF(Method)>(         \
        #Method, context, __VA_ARGS__);                                                     \
  }
