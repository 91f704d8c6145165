// The service that docs/writing-a-service.md shows: its code is what the page says, and as a
// process it does what the page says.
#include <gmock/gmock.h>
#include <grpcpp/grpcpp.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <map>
#include <memory>
#include <sstream>
#include <string>
#include <vector>

#include "common/base/errors.h"
#include "common/base/field_violations.h"
#include "common/base/files.h"
#include "common/rpc/status_mapping.h"
#include "notes.grpc.pb.h"
#include "tests/integration/services/service_under_test.h"

namespace mortise::notes {
namespace {

using ::testing::ElementsAre;
using ::testing::UnorderedElementsAre;

constexpr char kFolder[] = "tests/integration/common/notes/";

// The fenced blocks of a page that name a file: "```cpp note_methods.cpp".
std::map<std::string, std::string> FilesOfPage(const std::string& page) {
  std::istringstream lines(page);
  std::map<std::string, std::string> files;
  std::string* block = nullptr;
  bool is_within = false;
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with("```")) {
      const std::size_t blank = line.find(' ');
      is_within = !is_within;
      block = is_within && blank != std::string::npos && line.find('.', blank) != std::string::npos
                  ? &files[line.substr(blank + 1)]
                  : nullptr;
    } else if (block != nullptr) {
      *block += line + "\n";
    }
  }
  return files;
}

TEST(WritingAService, ShowsTheFilesAsTheyAre) {
  const char* const folder = std::getenv("MORTISE_SOURCE_DIR");
  const std::filesystem::path source = folder == nullptr ? "." : folder;
  const auto page = ReadFile(source / "docs/writing-a-service.md");
  ASSERT_TRUE(page.ok()) << page.status();
  const std::map<std::string, std::string> shown = FilesOfPage(*page);
  std::vector<std::string> names;
  for (const auto& [name, text] : shown) {
    names.push_back(name);
    const auto file = ReadFile(source / kFolder / name);
    ASSERT_TRUE(file.ok()) << file.status();
    EXPECT_EQ(text, *file) << name << " of the page is not " << kFolder << name;
  }
  EXPECT_THAT(names, UnorderedElementsAre("CMakeLists.txt", "main.cpp", "note_methods.cpp",
                                          "note_methods.h", "notes.proto", "notes_service.cpp",
                                          "notes_service.h"));
}

class NotesService : public ::testing::Test {
 protected:
  template <typename Request, typename Response>
  absl::StatusOr<Response> Call(grpc::Status (NoteService::Stub::*method)(grpc::ClientContext*,
                                                                          const Request&,
                                                                          Response*),
                                const Request& request) {
    grpc::ClientContext context;
    Response response;
    const absl::Status status = rpc::FromGrpc((stub_.get()->*method)(&context, request, &response));
    if (!status.ok()) return status;
    return response;
  }

  Note Create(const std::string& request_id, const std::string& external_id) {
    CreateNoteRequest request;
    request.set_request_id(request_id);
    request.set_subject("templates/table");
    request.set_text("Rounder, please.");
    request.add_external_ids(external_id);
    (*request.mutable_labels())["customer"] = "acme";
    const auto note = Call(&NoteService::Stub::CreateNote, request);
    EXPECT_TRUE(note.ok()) << note.status();
    return note.value_or(Note());
  }

  const mortise::testing::ServiceUnderTest process_{"mortise-notes", {}};
  const std::unique_ptr<NoteService::Stub> stub_ = NoteService::NewStub(process_.channel());
};

TEST_F(NotesService, KeepsWhatItIsGiven) {
  const Note note = Create("r-1", "1");
  EXPECT_EQ(note.creator(), "users/developer");
  EXPECT_TRUE(note.has_create_time());
  EXPECT_EQ(Create("r-1", "1").name(), note.name()) << "the same request again";
  GetNoteRequest get;
  get.set_name(note.name());
  const auto read = Call(&NoteService::Stub::GetNote, get);
  ASSERT_TRUE(read.ok()) << read.status();
  EXPECT_EQ(read->text(), "Rounder, please.");
  EXPECT_EQ(read->labels().at("customer"), "acme");
}

TEST_F(NotesService, ListsByWhatEveryResourceHas) {
  const Note one = Create("r-1", "1");
  const Note two = Create("r-2", "2");
  const auto names = [this](const ListNotesRequest& request) {
    const auto list = Call(&NoteService::Stub::ListNotes, request);
    EXPECT_TRUE(list.ok()) << list.status();
    std::vector<std::string> found;
    if (list.ok()) {
      for (const Note& note : list->notes()) found.push_back(note.name());
    }
    return found;
  };
  ListNotesRequest request;
  EXPECT_THAT(names(request), ElementsAre(two.name(), one.name()));
  request.mutable_filter()->set_external_id("1");
  (*request.mutable_filter()->mutable_labels())["customer"] = "";
  EXPECT_THAT(names(request), ElementsAre(one.name()));
  request.set_subject("templates/shelf");
  EXPECT_THAT(names(request), ElementsAre());
}

TEST_F(NotesService, ChangesLabels) {
  UpdateNoteRequest request;
  request.set_request_id("r-2");
  request.mutable_note()->set_name(Create("r-1", "1").name());
  (*request.mutable_note()->mutable_labels())["done"] = "";
  request.mutable_update_mask()->add_paths("labels");
  const auto note = Call(&NoteService::Stub::UpdateNote, request);
  ASSERT_TRUE(note.ok()) << note.status();
  EXPECT_THAT(note->external_ids(), ElementsAre("1"));
  EXPECT_EQ(note->labels().size(), 1u);
  EXPECT_TRUE(note->labels().contains("done"));
}

TEST_F(NotesService, TellsAllThatIsWrongAtOnce) {
  CreateNoteRequest request;
  request.set_request_id("r-1");
  request.set_subject("table");
  request.add_external_ids("");
  const absl::Status refused = Call(&NoteService::Stub::CreateNote, request).status();
  std::vector<std::string> fields;
  for (const FieldViolation& violation : ViolationsOf(refused)) fields.push_back(violation.field);
  EXPECT_THAT(fields, UnorderedElementsAre("subject", "text", "external_ids[0]"));
}

}  // namespace
}  // namespace mortise::notes
