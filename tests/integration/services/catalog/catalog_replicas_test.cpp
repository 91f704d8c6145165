// Several catalogs on one PostgreSQL: they start together, load different collections, and sweep
// and forget beside each other's imports and uploads.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "common/base/digest.h"
#include "common/base/errors.h"
#include "common/base/files.h"
#include "common/files/collection.h"
#include "mortise/v1/assembly.grpc.pb.h"
#include "mortise/v1/catalog.grpc.pb.h"
#include "services/catalog/records/catalog_records.h"
#include "services/catalog/records/drawing_records.h"
#include "services/catalog/records/shape_records.h"
#include "services/catalog/records/shape_sweep.h"
#include "services/catalog/service/collection_loader.h"
#include "tests/integration/services/call_service.h"
#include "tests/support/child_process.h"
#include "tests/support/private_postgresql.h"
#include "tests/support/status_assertions.h"
#include "tests/support/temporary_folder.h"

namespace mortise::catalog {
namespace {

// One cluster for the whole program.
const std::string& PostgresqlUrl() {
  static const auto cluster = testing::PrivatePostgresql::Start();
  static const std::string url = cluster.ok() ? (*cluster)->url() : "";
  if (!cluster.ok()) ADD_FAILURE() << cluster.status();
  return url;
}

// Runs all at the same time.
void RunAtOnce(const std::vector<std::function<void()>>& works) {
  std::atomic<std::size_t> ready = 0;
  std::vector<std::thread> threads;
  for (const auto& work : works) {
    threads.emplace_back([&] {
      ++ready;
      while (ready < works.size()) std::this_thread::yield();
      work();
    });
  }
  for (std::thread& thread : threads) thread.join();
}

v1::Shape Tetrahedron(double size) {
  mesh::SurfaceMesh surface;
  surface.vertices.resize(3, 4);
  surface.vertices << 0, size, 0, 0, 0, 0, size, 0, 0, 0, 0, size;
  surface.triangles.resize(3, 4);
  surface.triangles << 0, 0, 0, 1, 2, 1, 3, 2, 1, 3, 2, 3;
  return NamedShape(mesh::ShapeOfMesh(surface).value());
}

v1::Item Knob(const std::string& id, const std::string& shape) {
  v1::Item item;
  item.set_name("items/" + id);
  item.set_title(id);
  item.set_kind(v1::HARDWARE);
  item.set_material("materials/wood");
  item.set_shape(shape);
  item.set_price_basis(v1::PER_PIECE);
  item.mutable_price()->set_currency("EUR");
  item.mutable_price()->set_amount(1);
  item.set_price_date("2026-01-15");
  for (const v1::Axis axis : {v1::X, v1::Y, v1::Z}) {
    v1::ItemDimension& dimension = *item.add_dimensions();
    dimension.set_axis(axis);
    dimension.set_size(0.1);
  }
  return item;
}

// Two replicas' stores, with one clock and one folder of blobs.
class CatalogReplicasTest : public ::testing::Test {
 protected:
  void SetUp() override { OpenStores(); }

  // On tables of their own. Nobody waits for others: whoever is in the way is told at once.
  void OpenStores(absl::Duration patience = absl::Seconds(15)) {
    static std::atomic<int> last_service = 0;
    const std::string service = absl::StrCat("catalog-", ++last_service);
    for (auto* replica : {&first_, &second_}) {
      auto opened = store::OpenStore({.url = PostgresqlUrl(),
                                      .blob_folder = folder_.path() / "blobs",
                                      .service = service,
                                      .patience = patience,
                                      .clock = [this] { return absl::FromUnixSeconds(now_); }});
      ASSERT_OK(opened);
      *replica = *std::move(opened);
    }
    blobs_ = first_->Blobs().value();
  }

  // A collection of a wood and a knob of this price.
  std::filesystem::path Ship(const std::string& name, int64_t number, double price) {
    const std::filesystem::path folder = folder_.path() / name;
    EXPECT_OK(WriteFile(folder / "materials.textproto",
                        "# proto-file: mortise/v1/template.proto\n"
                        "# proto-message: mortise.v1.TemplateBundle\n"
                        "materials { name: 'materials/wood' title: 'wood' density: 500 "
                        "youngs_modulus: 1e10 poissons_ratio: 0.3 strength: 2e7 }\n"));
    EXPECT_OK(WriteFile(
        folder / "items" / "hardware.csv",
        absl::StrCat("name,title,kind,material,length_mm,width_mm,thickness_mm,price,currency,"
                     "price_date,price_is_example\n"
                     "items/knob,knob,HARDWARE,materials/wood,30,30,27,",
                     price, ",EUR,2026-01-15,true\n")));
    const auto shipped = parametric::ReadCollection(folder);
    EXPECT_OK(shipped);
    EXPECT_OK(WriteFile(
        folder / "versions.csv",
        absl::StrCat("number,digest\n", number, ",", parametric::ContentDigest(*shipped), "\n")));
    return folder;
  }

  absl::StatusOr<v1::Item> GetKnob(store::Store& store) {
    v1::Item item;
    MORTISE_RETURN_IF_ERROR(store.Read([&](store::ReadTransaction& transaction) -> absl::Status {
      MORTISE_ASSIGN_OR_RETURN(item, GetItem(transaction, "items/knob"));
      return absl::OkStatus();
    }));
    return item;
  }

  absl::StatusOr<std::string> Upload(store::Store& store, const std::string& bytes) {
    const auto reader = ReceiveDrawing(&store, blobs_);
    v1::Chunk chunk;
    chunk.set_data(bytes);
    chunk.set_total_size(static_cast<int64_t>(bytes.size()));
    MORTISE_RETURN_IF_ERROR(reader->OnMessage(chunk));
    MORTISE_ASSIGN_OR_RETURN(const v1::UploadDrawingResponse response, reader->Complete());
    return response.sha256();
  }

  void PassTime(absl::Duration duration) { now_ += absl::ToInt64Seconds(duration); }

  testing::TemporaryFolder folder_;
  std::atomic<int64_t> now_ = 1'700'000'000;
  std::unique_ptr<store::Store> first_, second_;
  ParametrizationCache first_parametrized_{std::size_t{64} << 20};
  ParametrizationCache second_parametrized_{std::size_t{64} << 20};
  store::BlobFolder* blobs_ = nullptr;
};

TEST_F(CatalogReplicasTest, LoadOneCollectionTogether) {
  const auto folder = Ship("collection", 1, 2);
  for (int round = 0; round < 10; ++round) {
    OpenStores(absl::ZeroDuration());
    absl::StatusOr<CollectionReport> one, other;
    RunAtOnce({[&] { one = LoadCollection(*first_, folder, first_parametrized_); },
               [&] { other = LoadCollection(*second_, folder, second_parametrized_); }});
    ASSERT_OK(one);
    ASSERT_OK(other);
    EXPECT_EQ(one->created.size() + other->created.size(), 2u);
    EXPECT_EQ(one->updated.size() + other->updated.size(), 0u);
    EXPECT_EQ(GetKnob(*first_)->revision(), 1);
  }
}

TEST_F(CatalogReplicasTest, OlderAndNewerTogetherEndWithTheNewer) {
  const auto older = Ship("older", 1, 1), newer = Ship("newer", 2, 2);
  for (int round = 0; round < 10; ++round) {
    OpenStores();
    absl::StatusOr<CollectionReport> one, other;
    RunAtOnce({[&] { one = LoadCollection(*first_, older, first_parametrized_); },
               [&] { other = LoadCollection(*second_, newer, second_parametrized_); }});
    ASSERT_OK(one);
    ASSERT_OK(other);
    EXPECT_EQ(GetKnob(*first_)->price().amount(), 2);
    ASSERT_OK(LoadCollection(*first_, older, first_parametrized_));
    EXPECT_EQ(GetKnob(*first_)->price().amount(), 2);
  }
}

TEST_F(CatalogReplicasTest, ASweepLeavesNoItemWithoutItsShape) {
  ASSERT_OK(LoadCollection(*first_, Ship("collection", 1, 2), first_parametrized_));
  const v1::Shape shape = Tetrahedron(0.1);
  for (int round = 0; round < 20; ++round) {
    ASSERT_OK(first_->Transact(
        [&](store::Transaction& transaction) { return PutShape(transaction, shape).status(); }));
    PassTime(absl::Hours(2));
    absl::Status created;
    absl::StatusOr<std::vector<std::string>> swept;
    const std::string id = absl::StrCat("shaped-", round);
    RunAtOnce({[&] {
                 created = first_->Transact([&](store::Transaction& transaction) {
                   return CreateItem(transaction, Knob(id, shape.name()), {}).status();
                 });
               },
               [&] { swept = SweepShapes(*second_); }});
    ASSERT_OK(swept);
    const absl::Status there = first_->Read([&](store::ReadTransaction& transaction) {
      return GetShape(transaction, shape.name()).status();
    });
    EXPECT_EQ(created.ok(), there.ok()) << created << there;
    if (!created.ok()) {
      EXPECT_EQ(DetailOf(created).field, "item.shape") << created;
      continue;
    }
    ASSERT_OK(first_->Transact([&](store::Transaction& transaction) {
      v1::DeleteItemRequest request;
      request.set_name("items/" + id);
      request.set_revision(1);
      return DeleteItem(transaction, request, {});
    }));
  }
}

TEST_F(CatalogReplicasTest, ForgettingADrawingDoesNotTakeTheSameUpload) {
  const std::string bytes(2000, 'x');
  for (int round = 0; round < 100; ++round) {
    ASSERT_OK(Upload(*first_, bytes));
    PassTime(absl::Hours(25));
    absl::StatusOr<std::string> again;
    absl::StatusOr<int64_t> forgotten;
    RunAtOnce({[&] { again = Upload(*first_, bytes); },
               [&] {
                 forgotten = rpc::ForgetUploaded(*second_, blobs_, Drawings(),
                                                 second_->Now() - absl::Hours(24));
               }});
    ASSERT_OK(again);
    ASSERT_OK(forgotten);
    const auto kept = GetDrawing(second_.get(), blobs_, *again);
    ASSERT_OK(kept) << "round " << round;
  }
}

TEST_F(CatalogReplicasTest, AnUploadThatIsRefusedDoesNotTakeTheSameUpload) {
  for (int round = 0; round < 50; ++round) {
    const std::string bytes = absl::StrCat("drawing ", round);
    absl::StatusOr<std::string> kept;
    absl::Status refused;
    RunAtOnce({[&] { kept = Upload(*first_, bytes); },
               [&] {
                 const auto reader = ReceiveDrawing(second_.get(), blobs_);
                 v1::Chunk chunk;
                 chunk.set_data(bytes);
                 chunk.set_total_size(static_cast<int64_t>(bytes.size()));
                 chunk.set_sha256(std::string(64, '0'));
                 refused = reader->OnMessage(chunk);
                 if (refused.ok()) refused = reader->Complete().status();
               }});
    EXPECT_EQ(DetailOf(refused).field, "sha256") << refused;
    ASSERT_OK(kept);
    EXPECT_OK(GetDrawing(first_.get(), blobs_, *kept));
  }
}

// The two as processes, with the items that ship and an assembly.
class CatalogProcesses : public ::testing::Test {
 protected:
  CatalogProcesses() {
    const char* source = std::getenv("MORTISE_SOURCE_DIR");
    const std::filesystem::path shipped =
        std::filesystem::path(source == nullptr ? "." : source) / "collection";
    for (const char* name :
         {"materials.textproto", "items", "shapes", "assemblies/bookshelf.textproto"}) {
      std::filesystem::create_directories((collection_ / name).parent_path());
      std::filesystem::copy(shipped / name, collection_ / name,
                            std::filesystem::copy_options::recursive);
    }
  }

  // A child ends with the thread that started it.
  void StartAndLook(const std::string& replica) {
    const testing::ServiceProcess process(
        testing::BuiltProgram("mortise-catalog"),
        {"--insecure-development", "--log-level=warning", "--listen=127.0.0.1:0", "--store=" + url_,
         "--blobs=" + (folder_.path() / "blobs").string(), "--replica=" + replica,
         "--collection=" + collection_.string()},
        folder_.path() / (replica + ".json"));
    const auto channel = grpc::CreateChannel(process.address(), grpc::InsecureChannelCredentials());
    const auto catalog = v1::CatalogService::NewStub(channel);
    v1::ListItemsRequest page;
    page.set_page_size(1000);
    ASSERT_OK_AND_ASSIGN(const v1::ListItemsResponse items,
                         testing::Call(*catalog, &v1::CatalogService::Stub::ListItems, page));
    EXPECT_GT(items.items_size(), 400);
    for (const v1::Item& item : items.items()) EXPECT_EQ(item.revision(), 1) << item.name();
    const auto assemblies = v1::AssemblyService::NewStub(channel);
    ASSERT_OK_AND_ASSIGN(const v1::ListAssembliesResponse drawn,
                         testing::Call(*assemblies, &v1::AssemblyService::Stub::ListAssemblies,
                                       v1::ListAssembliesRequest()));
    EXPECT_EQ(drawn.assemblies_size(), 1);
    for (const v1::Assembly& assembly : drawn.assemblies()) EXPECT_EQ(assembly.revision(), 1);
    ++served_;
  }

  const std::string url_ = PostgresqlUrl();  // the server ends with the thread that started it
  const testing::TemporaryFolder folder_;
  const std::filesystem::path collection_ = folder_.path() / "collection";
  std::atomic<int> served_ = 0;
};

TEST_F(CatalogProcesses, StartTogetherOnAnEmptyStore) {
  const auto look = [this](const std::string& replica) {
    try {
      StartAndLook(replica);
    } catch (const std::exception& error) {  // it did not start
      ADD_FAILURE() << replica << ": " << error.what();
    }
  };
  RunAtOnce({[&] { look("one"); }, [&] { look("two"); }});
  EXPECT_EQ(served_, 2);
}

}  // namespace
}  // namespace mortise::catalog
