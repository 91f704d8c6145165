// Reads what a request wants of designs beside their metrics, and tells what a file of shape and
// fields has.
#pragma once

#include <string>

#include "common/fields/design_fields.h"
#include "common/fields/fields_file.h"
#include "mortise/v1/evaluator.pb.h"
#include "services/simulator/analysis/design_fields.h"

namespace mortise::simulator {

FieldsDemand ReadDemand(const v1::DesignFieldsRequest& request);

fields::WriteOptions ReadWriteOptions(const v1::DesignFieldsRequest& request);

// Returns what results say of the file of `design` that has this digest and size, bytes.
v1::DesignFields Describe(const fields::DesignFields& design, const std::string& sha256,
                          std::size_t size);

}  // namespace mortise::simulator
