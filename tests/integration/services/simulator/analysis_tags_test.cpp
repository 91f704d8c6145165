// Analyses by what callers attach to them: external ids and labels, from the request to the list.
// The test is the worker, as nothing needs to be computed.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <string>
#include <vector>

#include "common/base/identifiers.h"
#include "common/store/store.h"
#include "tests/integration/services/call_service.h"
#include "tests/integration/services/simulator/mesh_service.h"

namespace mortise::simulator {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

using Service = v1::SimulatorService::Stub;

template <class Request>
Request WithTags(Request request, const std::string& external_id, const std::string& project) {
  request.add_external_ids(external_id);
  if (!project.empty()) (*request.mutable_labels())["project"] = project;
  return request;
}

class AnalysisTagsTest : public MeshServiceTest {
 protected:
  static v1::AnalyzeDesignRequest Table() {
    v1::AnalyzeDesignRequest request;
    request.set_request_id(NewIdentifier());
    request.set_template_("templates/table");
    return request;
  }

  v1::AnalyzeMeshRequest UploadedBar() {
    return Bar(Upload(testing::WriteGmsh41(box_, true)), NewIdentifier());
  }

  v1::Task LeaseOne() {
    v1::LeaseTasksRequest request;
    request.set_worker("test");
    request.set_limit(1);
    request.set_wait_seconds(50);
    const auto leased = testing::Call(*Simulator(), &Service::LeaseTasks, request);
    EXPECT_TRUE(leased.ok()) << leased.status();
    EXPECT_EQ(leased.ok() ? leased->tasks_size() : 0, 1);
    return leased.ok() && leased->tasks_size() > 0 ? leased->tasks(0) : v1::Task();
  }

  // Reports what a worker might: a metric, and claims of its own about the analysis.
  void Report(const v1::Task& task) {
    v1::ReportTaskRequest report;
    report.mutable_task()->set_name(task.name());
    report.mutable_task()->set_attempt(task.attempt());
    v1::Metric& metric = *report.mutable_result()->add_metrics();
    metric.set_name("mass");
    metric.set_value(7);
    report.mutable_analysis()->set_creator("users/eve");
    report.mutable_analysis()->add_external_ids("of the worker");
    const auto answer = testing::Call(*Simulator(), &Service::ReportTask, report);
    EXPECT_TRUE(answer.ok()) << answer.status();
  }

  // The analysis that a request makes.
  template <class Request>
  v1::Analysis Analyse(grpc::Status (Service::*method)(grpc::ClientContext*, const Request&,
                                                       v1::Operation*),
                       const Request& request) {
    const auto operation = testing::Call(*Simulator(), method, request);
    EXPECT_TRUE(operation.ok()) << operation.status();
    if (!operation.ok()) return {};
    Report(LeaseOne());
    return ResultOf(Wait(operation->name()));
  }

  v1::Analysis Get(const std::string& name) {
    v1::GetAnalysisRequest request;
    request.set_name(name);
    const auto analysis = testing::Call(*Simulator(), &Service::GetAnalysis, request);
    EXPECT_TRUE(analysis.ok()) << analysis.status();
    return analysis.value_or(v1::Analysis());
  }

  std::vector<std::string> Listed(const std::function<void(v1::ListAnalysesRequest&)>& ask) {
    v1::ListAnalysesRequest request;
    ask(request);
    const auto page = testing::Call(*Simulator(), &Service::ListAnalyses, request);
    EXPECT_TRUE(page.ok()) << page.status();
    std::vector<std::string> names;
    if (!page.ok()) return names;
    for (const v1::Analysis& analysis : page->analyses()) names.push_back(analysis.name());
    return names;
  }

  absl::StatusOr<v1::Analysis> Update(const v1::Analysis& changes,
                                      const std::vector<std::string>& mask = {}) {
    v1::UpdateAnalysisRequest request;
    request.set_request_id(NewIdentifier());
    *request.mutable_analysis() = changes;
    for (const std::string& path : mask) request.mutable_update_mask()->add_paths(path);
    return testing::Call(*Simulator(), &Service::UpdateAnalysis, request);
  }
};

TEST_F(AnalysisTagsTest, AreThoseOfTheRequest) {
  const v1::Analysis design =
      Analyse(&Service::AnalyzeDesign, WithTags(Table(), "100-1", "kitchen"));
  const v1::Analysis mesh =
      Analyse(&Service::AnalyzeMesh, WithTags(UploadedBar(), "100-1", "kitchen"));
  for (const v1::Analysis& analysis : {design, mesh, Get(design.name()), Get(mesh.name())}) {
    EXPECT_THAT(analysis.external_ids(), ElementsAre("100-1"));
    EXPECT_EQ(analysis.labels().size(), 1u);
    EXPECT_EQ(analysis.labels().at("project"), "kitchen");
    EXPECT_EQ(analysis.creator(), "users/developer");
    EXPECT_GT(analysis.create_time().seconds(), 0);
    EXPECT_EQ(analysis.metrics_size(), 1);
  }
}

TEST_F(AnalysisTagsTest, ListAnalysesByFilterAndSubject) {
  const v1::Analysis kitchen =
      Analyse(&Service::AnalyzeDesign, WithTags(Table(), "100-1", "kitchen"));
  const v1::Analysis hall = Analyse(&Service::AnalyzeDesign, WithTags(Table(), "100-2", "hall"));
  const v1::Analysis bar = Analyse(&Service::AnalyzeMesh, WithTags(UploadedBar(), "100-2", ""));

  const auto all = ElementsAre(bar.name(), hall.name(), kitchen.name());
  EXPECT_THAT(Listed([](auto&) {}), all);
  EXPECT_THAT(Listed([](auto& list) { list.mutable_filter()->set_external_id("100-2"); }),
              ElementsAre(bar.name(), hall.name()));
  const auto labelled = [](const std::string& value) {
    return [value](auto& list) { (*list.mutable_filter()->mutable_labels())["project"] = value; };
  };
  EXPECT_THAT(Listed(labelled("kitchen")), ElementsAre(kitchen.name()));
  EXPECT_THAT(Listed(labelled("")), ElementsAre(hall.name(), kitchen.name()));
  EXPECT_THAT(Listed([](auto& list) { list.mutable_filter()->set_creator("users/developer"); }),
              all);
  EXPECT_THAT(Listed([](auto& list) { list.mutable_filter()->set_creator("users/eve"); }),
              IsEmpty());
  EXPECT_THAT(Listed([&](auto& list) {
                *list.mutable_filter()->mutable_created_from() = hall.create_time();
              }),
              ElementsAre(bar.name(), hall.name()));
  EXPECT_THAT(Listed([&](auto& list) {
                *list.mutable_filter()->mutable_created_before() = hall.create_time();
              }),
              ElementsAre(kitchen.name()));
  EXPECT_THAT(Listed([](auto& list) { list.set_subject("templates/table"); }),
              ElementsAre(hall.name(), kitchen.name()));
  EXPECT_THAT(Listed([](auto& list) { list.set_subject("templates/chair"); }), IsEmpty());
}

TEST_F(AnalysisTagsTest, ChangeAndNothingElseDoes) {
  const v1::Analysis before =
      Analyse(&Service::AnalyzeDesign, WithTags(Table(), "100-1", "kitchen"));
  v1::Analysis changes;
  changes.set_name(before.name());
  changes.add_external_ids("PLM 7");
  changes.set_title("Another");
  const auto updated = Update(changes, {"external_ids"});
  ASSERT_TRUE(updated.ok()) << updated.status();
  v1::Analysis expected = before;
  expected.set_external_ids(0, "PLM 7");
  EXPECT_EQ(updated->DebugString(), expected.DebugString());
  service_.Kill();
  service_.Start();
  EXPECT_EQ(Get(before.name()).DebugString(), expected.DebugString());
  EXPECT_THAT(Listed([](auto& list) { list.mutable_filter()->set_external_id("100-1"); }),
              IsEmpty());
}

TEST_F(AnalysisTagsTest, SurviveKillNine) {
  const auto operation =
      testing::Call(*Simulator(), &Service::AnalyzeDesign, WithTags(Table(), "100-1", "kitchen"));
  ASSERT_TRUE(operation.ok()) << operation.status();
  const v1::Task task = LeaseOne();
  service_.Kill();
  service_.Start();
  Report(task);
  const v1::Analysis analysis = ResultOf(Wait(operation->name()));
  EXPECT_THAT(analysis.external_ids(), ElementsAre("100-1"));
  EXPECT_EQ(analysis.creator(), "users/developer");
}

TEST_F(AnalysisTagsTest, ThatAreWrongAreToldWithAllElse) {
  v1::AnalyzeDesignRequest design = WithTags(Table(), "100-1", "kitchen");
  design.add_external_ids("");
  design.set_modes(-1);
  absl::Status refused = testing::Call(*Simulator(), &Service::AnalyzeDesign, design).status();
  EXPECT_TRUE(absl::IsInvalidArgument(refused)) << refused;
  EXPECT_THAT(std::string(refused.message()),
              AllOf(HasSubstr("modes"), HasSubstr("external_ids[1]")));

  v1::AnalyzeMeshRequest mesh = WithTags(Bar(std::string(64, '0'), NewIdentifier()), "100-1", "");
  (*mesh.mutable_labels())["a b"] = "";
  mesh.mutable_case_()->clear_length_unit();
  refused = testing::Call(*Simulator(), &Service::AnalyzeMesh, mesh).status();
  EXPECT_TRUE(absl::IsInvalidArgument(refused)) << refused;
  EXPECT_THAT(std::string(refused.message()),
              AllOf(HasSubstr("case.length_unit"), HasSubstr("mesh_file"), HasSubstr("labels")));

  v1::Analysis changes;
  changes.set_name("analyses/absent");
  EXPECT_TRUE(absl::IsNotFound(Update(changes).status()));
  changes.add_external_ids("");
  refused = Update(changes, {"metrics"}).status();
  EXPECT_TRUE(absl::IsInvalidArgument(refused)) << refused;
  EXPECT_THAT(std::string(refused.message()),
              AllOf(HasSubstr("analysis.external_ids[0]"), HasSubstr("update_mask")));
}

TEST_F(AnalysisTagsTest, OfListsThatCannotBeAreToldTogether) {
  for (const char* subject : {"table", "templates/", "evaluators/beam", "templates/a/b"}) {
    v1::ListAnalysesRequest list;
    list.set_subject(subject);
    list.set_page_size(-1);
    (*list.mutable_filter()->mutable_labels())["a b"] = "";
    const absl::Status refused = testing::Call(*Simulator(), &Service::ListAnalyses, list).status();
    EXPECT_TRUE(absl::IsInvalidArgument(refused)) << refused;
    EXPECT_THAT(std::string(refused.message()),
                AllOf(HasSubstr("subject"), HasSubstr("page_size"), HasSubstr("filter.labels")));
  }
}

}  // namespace
}  // namespace mortise::simulator
