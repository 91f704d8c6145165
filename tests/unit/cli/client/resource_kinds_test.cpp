// Every resource of the contract is a kind that commands can list, show and change.
#include "cli/client/resource_kinds.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

#include "common/base/errors.h"
#include "mortise/v1/types.pb.h"

namespace mortise::cli {
namespace {

using google::protobuf::Descriptor;
using google::protobuf::FieldDescriptor;
using google::protobuf::FileDescriptor;
using google::protobuf::MethodDescriptor;

TEST(ResourceKinds, HaveTheMethodsThatTheirNamesSay) {
  for (const ResourceKind& kind : ResourceKinds()) {
    const FieldDescriptor& entries = EntriesField(kind);
    EXPECT_EQ(entries.json_name(), kind.names);
    EXPECT_EQ(GetMethod(kind).output_type(), entries.message_type()) << kind.names;
    const MethodDescriptor* const change = ChangeMethod(kind);
    if (std::string(kind.names) == "operations") {
      EXPECT_EQ(change, nullptr);
      continue;
    }
    ASSERT_NE(change, nullptr) << kind.names;
    EXPECT_EQ(change->output_type(), entries.message_type()) << kind.names;
    EXPECT_NE(change->input_type()->FindFieldByName("request_id"), nullptr) << kind.names;
  }
}

bool HasField(const ResourceKind& kind, std::string path) {
  const Descriptor* type = EntriesField(kind).message_type();
  for (std::size_t dot = path.find('.'); dot != std::string::npos; dot = path.find('.')) {
    const FieldDescriptor* const outer = type->FindFieldByName(path.substr(0, dot));
    if (outer == nullptr) return false;
    type = outer->message_type();
    path = path.substr(dot + 1);
  }
  return type->FindFieldByName(path) != nullptr;
}

TEST(ResourceKinds, HaveTheFieldsThatTellOfThem) {
  for (const ResourceKind& kind : ResourceKinds()) {
    EXPECT_TRUE(HasField(kind, kind.about)) << kind.names;
    if (*kind.geometry == '\0') continue;
    EXPECT_TRUE(HasField(kind, kind.geometry)) << kind.names;
  }
}

// A list with a filter that is no kind would be missing from `mortise find`.
TEST(ResourceKinds, AreAllListsWithAFilter) {
  std::set<const Descriptor*> listed;
  std::set<const FileDescriptor*> files;
  for (const ResourceKind& kind : ResourceKinds()) {
    listed.insert(kind.list_request());
    files.insert(kind.list_request()->file());
  }
  for (const FileDescriptor* const file : files) {
    for (int i = 0; i < file->message_type_count(); ++i) {
      const Descriptor* const type = file->message_type(i);
      const FieldDescriptor* const filter = type->FindFieldByName("filter");
      if (filter == nullptr || filter->message_type() != v1::ResourceFilter::descriptor()) continue;
      EXPECT_EQ(listed.count(type), 1u) << type->full_name();
    }
  }
}

TEST(ResourceKinds, AreFoundBySeveralSpellings) {
  ASSERT_NE(FindKind("workOrders"), nullptr);
  EXPECT_EQ(FindKind("work-orders"), FindKind("workOrders"));
  EXPECT_EQ(FindKind("workorders"), FindKind("workOrders"));
  EXPECT_EQ(FindKind("front"), nullptr);
  EXPECT_EQ(FindKind(""), nullptr);
}

TEST(ResourceKinds, AreKnownByNames) {
  EXPECT_EQ(*KindOfName("workOrders/0198c1"), FindKind("workOrders"));
  EXPECT_EQ(*KindOfName("operations/pareto/0198c1"), FindKind("operations"));
  for (const char* const name : {"", "table", "fronts/", "/0198c1", "shapes/0198c1"}) {
    const absl::Status status = KindOfName(name).status();
    EXPECT_EQ(DetailOf(status).field, "name") << name;
    EXPECT_THAT(std::string(status.message()), testing::HasSubstr("fronts, plans, workOrders"));
  }
}

}  // namespace
}  // namespace mortise::cli
