// Makes the covers that a task asks for: the work of an index, here or in a worker.
#pragma once

#include <functional>
#include <stop_token>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "common/rpc/channel.h"
#include "mortise/v1/retrieval.pb.h"
#include "services/retrieval/catalog/template_source.h"
#include "services/retrieval/descriptors/descriptor.h"

namespace mortise::retrieval {

// Changes with what is made of the same template: covers of another version are made again, and
// workers of another version make none.
inline constexpr char kCoverVersion[] = "cover 5";

// Returns the SHA-256 of all that a cover depends on; `content` is SearchedTemplate::digest.
std::string CoverDigest(const Descriptor& descriptor, double delta, const std::string& content);

// A cover, and its file: an index of the one family 0. No file where it has a fault.
struct CoverFile {
  v1::MadeCover made;
  std::string bytes;
};

// Takes a cover as soon as it is made; `last` where it is the last of the task's. What it fails
// with ends the work.
using KeepCover = std::function<absl::Status(CoverFile, bool last)>;

// Makes them one after the other. What is wrong with the template itself is the fault of its
// covers. Fails where it says nothing about the template: as IsPassingFailure; NOT_FOUND where the
// template is gone; FAILED_PRECONDITION, TEMPLATE_CHANGED, where it is not what was asked for, as
// its items have changed; CANCELLED when a stop is requested. The same task gives the same bits
// wherever it is done.
absl::Status MakeCovers(const v1::CoverTask& task, TemplateSource& templates,
                        const rpc::Origin& origin, const std::stop_token& stop,
                        const KeepCover& keep);

}  // namespace mortise::retrieval
