// Records of builds as other versions of sampling and mapping have left them.
#pragma once

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "common/base/errors.h"
#include "common/store/store.h"

namespace mortise::interpolator::testing {

inline std::vector<store::Record> RecordsOf(store::Store& store, const std::string& kind,
                                            const std::string& id) {
  std::vector<store::Record> records;
  const absl::Status read = store.Read([&](store::ReadTransaction& transaction) -> absl::Status {
    store::ListOptions list;
    list.key_prefix = id + "/";
    MORTISE_ASSIGN_OR_RETURN(records, transaction.List(kind, list));
    return absl::OkStatus();
  });
  EXPECT_TRUE(read.ok()) << read;
  return records;
}

// Puts what is kept of the build under the keys of an earlier version in place of the present
// one's, and without any version, as it was before there were some.
inline void MakeOld(store::Store& store, const std::string& kind, const std::string& id) {
  const absl::Status put = store.Transact([&](store::Transaction& transaction) -> absl::Status {
    for (const store::Record& record : RecordsOf(store, kind, id)) {
      const std::string name = record.key.substr(record.key.find('/', id.size() + 1));
      MORTISE_RETURN_IF_ERROR(
          transaction.Put(kind, id + "/sampling 0, mapping 0" + name, record.payload).status());
      MORTISE_RETURN_IF_ERROR(transaction.Put(kind, id + name, record.payload).status());
      MORTISE_RETURN_IF_ERROR(transaction.Delete(kind, record.key));
    }
    return absl::OkStatus();
  });
  EXPECT_TRUE(put.ok()) << put;
}

}  // namespace mortise::interpolator::testing
