// Header, digests, sections.
#include "services/retrieval/index/index_file.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstring>
#include <memory>
#include <span>
#include <type_traits>

#include "absl/strings/str_cat.h"
#include "common/base/digest.h"
#include "common/base/errors.h"
#include "common/base/files.h"
#include "services/retrieval/index/index_check.h"
#include "services/retrieval/index/mapped_file.h"

namespace mortise::retrieval {
namespace {

static_assert(std::endian::native == std::endian::little, "arrays are written as they are");

constexpr std::string_view kMagic = "MORTINDX";
constexpr std::size_t kAlignment = 8;
constexpr std::size_t kDigestSize = 64;
using DigestText = std::array<char, kDigestSize>;

constexpr std::array<std::string_view, 14> kSectionNames = {
    "mean",   "components",   "families", "primitives", "vectors", "radii", "parameters",
    "places", "leading axes", "drifts",   "nodes",      "balls",   "boxes", "about"};

struct SectionEntry {
  std::uint64_t offset = 0;
  std::uint64_t bytes = 0;  // with zeros up to the next multiple of eight
  DigestText digest = {};
};

struct Header {
  std::array<char, 8> magic = {};
  std::uint32_t version = 0;
  std::uint32_t header_bytes = 0;
  std::uint64_t file_bytes = 0;
  std::uint64_t about_bytes = 0;
  IndexSizes sizes;
  std::array<char, kMaxDescriptorName + 1> descriptor = {};  // filled up with zeros
  std::array<SectionEntry, kSectionNames.size()> sections = {};
  DigestText digest = {};  // of all before it
};

static_assert(std::is_trivially_copyable_v<Header> &&
              std::has_unique_object_representations_v<Header>);
static_assert(std::has_unique_object_representations_v<PrimitiveEntry> &&
              std::has_unique_object_representations_v<NodeEntry>);
static_assert(sizeof(DriftEntry) == 20 * sizeof(float));
static_assert(sizeof(Header) % kAlignment == 0);

DigestText DigestOf(std::string_view bytes) {
  DigestText digest;
  const std::string text = Sha256Hex(bytes);
  std::copy(text.begin(), text.end(), digest.begin());
  return digest;
}

DigestText DigestOf(const Header& header) {
  return DigestOf(
      std::string_view(reinterpret_cast<const char*>(&header), offsetof(Header, digest)));
}

template <typename T>
std::string_view BytesOf(std::span<const T> array) {
  return {reinterpret_cast<const char*>(array.data()), array.size_bytes()};
}

std::array<std::string_view, kSectionNames.size()> SectionsOf(const IndexArrays& arrays,
                                                              std::string_view about) {
  return {BytesOf(arrays.mean),         BytesOf(arrays.components),
          BytesOf(arrays.families),     BytesOf(arrays.primitives),
          BytesOf(arrays.vectors),      BytesOf(arrays.radii),
          BytesOf(arrays.parameters),   BytesOf(arrays.places),
          BytesOf(arrays.leading_axes), BytesOf(arrays.drifts),
          BytesOf(arrays.nodes),        BytesOf(arrays.balls),
          BytesOf(arrays.boxes),        about};
}

absl::Status Damaged(const std::filesystem::path& path, std::string_view how) {
  return WithDetail(absl::DataLossError(absl::StrCat("the index ", path.string(),
                                                     " is damaged: ", std::string(how))),
                    {"INDEX_DAMAGED", path.string()});
}

absl::StatusOr<Header> ReadHeader(std::string_view bytes, std::string_view descriptor,
                                  const std::filesystem::path& path) {
  Header header;
  if (bytes.size() < sizeof(Header)) return Damaged(path, "it is shorter than a header");
  std::memcpy(&header, bytes.data(), sizeof(Header));
  if (std::string_view(header.magic.data(), header.magic.size()) != kMagic) {
    return Damaged(path, "it does not begin as an index does");
  }
  if (header.version != kIndexVersion) {
    return PreconditionFailed(
        "INDEX_OF_ANOTHER_VERSION",
        absl::StrCat("the index ", path.string(), " is of version ", header.version,
                     ", and this program reads ", kIndexVersion),
        path.string());
  }
  if (header.digest != DigestOf(header)) return Damaged(path, "its header was changed");
  if (header.header_bytes != sizeof(Header) || header.descriptor.back() != 0) {
    return Damaged(path, "its header is none");
  }
  if (header.file_bytes != bytes.size()) {
    return Damaged(path,
                   absl::StrCat("it has ", bytes.size(), " bytes instead of ", header.file_bytes));
  }
  if (descriptor != header.descriptor.data()) {
    return PreconditionFailed(
        "INDEX_OF_ANOTHER_DESCRIPTOR",
        absl::StrCat("the index ", path.string(), " is of the descriptor '",
                     header.descriptor.data(), "', not '", std::string(descriptor), "'"),
        path.string());
  }
  return header;
}

// The sections lie one after the other up to the end, each as its digest says.
absl::Status CheckSections(const Header& header, std::string_view bytes,
                           const std::filesystem::path& path) {
  std::uint64_t end = sizeof(Header);
  for (std::size_t i = 0; i < kSectionNames.size(); ++i) {
    const SectionEntry& section = header.sections[i];
    if (section.offset != end || section.bytes % kAlignment != 0 ||
        section.bytes > bytes.size() - end) {
      return Damaged(
          path, absl::StrCat("its section '", std::string(kSectionNames[i]), "' lies elsewhere"));
    }
    end += section.bytes;
    if (DigestOf(bytes.substr(section.offset, section.bytes)) != section.digest) {
      return Damaged(path,
                     absl::StrCat("its section '", std::string(kSectionNames[i]), "' was changed"));
    }
  }
  if (end != bytes.size()) return Damaged(path, "something follows its last section");
  return absl::OkStatus();
}

// Hands out the sections as arrays; remembers whether all had room.
class SectionReader {
 public:
  SectionReader(const Header& header, std::string_view bytes) : header_(header), bytes_(bytes) {}

  template <typename T>
  std::span<const T> Next(std::int64_t count) {
    const SectionEntry& section = header_.sections[next_++];
    if (count < 0 || static_cast<std::uint64_t>(count) > section.bytes / sizeof(T)) {
      fits_ = false;
      return {};
    }
    return {reinterpret_cast<const T*>(bytes_.data() + section.offset),
            static_cast<std::size_t>(count)};
  }

  bool fits() const { return fits_; }

 private:
  const Header& header_;
  std::string_view bytes_;
  std::size_t next_ = 0;
  bool fits_ = true;
};

absl::StatusOr<IndexArrays> ArraysOf(const Header& header, std::string_view bytes,
                                     std::string* about, const std::filesystem::path& path) {
  const IndexSizes& sizes = header.sizes;
  SectionReader reader(header, bytes);
  IndexArrays arrays;
  arrays.sizes = sizes;
  arrays.mean = reader.Next<double>(sizes.dimension);
  arrays.components = reader.Next<double>(sizes.dimension * sizes.leading);
  arrays.families = reader.Next<std::int32_t>(sizes.families);
  arrays.primitives = reader.Next<PrimitiveEntry>(sizes.primitives);
  arrays.vectors = reader.Next<float>(sizes.vectors);
  arrays.radii = reader.Next<double>(sizes.radii);
  arrays.parameters = reader.Next<double>(sizes.parameters);
  arrays.places = reader.Next<double>(sizes.primitives * (sizes.leading + 2));
  arrays.leading_axes = reader.Next<double>(sizes.radii * (sizes.leading + 1));
  arrays.drifts = reader.Next<DriftEntry>(sizes.primitives);
  arrays.nodes = reader.Next<NodeEntry>(sizes.nodes);
  arrays.balls = reader.Next<double>(sizes.nodes * (sizes.leading + 2));
  arrays.boxes = reader.Next<double>(sizes.nodes * 2 * (sizes.leading + 1));
  const auto text = reader.Next<char>(static_cast<std::int64_t>(header.about_bytes));
  if (!reader.fits() || !AreConsistent(arrays)) return Damaged(path, "its arrays do not fit");
  about->assign(text.begin(), text.end());
  return arrays;
}

}  // namespace

absl::StatusOr<std::string> IndexBytes(const PrimitiveIndex& index, std::string_view descriptor,
                                       std::string_view about) {
  if (descriptor.empty() || descriptor.size() > kMaxDescriptorName ||
      descriptor.find('\0') != std::string_view::npos) {
    return InvalidField("descriptor", absl::StrCat("must have 1 to ", kMaxDescriptorName,
                                                   " bytes, none of them zero"));
  }
  Header header{.version = kIndexVersion,
                .header_bytes = sizeof(Header),
                .about_bytes = about.size(),
                .sizes = index.arrays().sizes};
  std::copy(kMagic.begin(), kMagic.end(), header.magic.begin());
  std::copy(descriptor.begin(), descriptor.end(), header.descriptor.begin());
  std::string bytes(sizeof(Header), '\0');
  const auto sections = SectionsOf(index.arrays(), about);
  for (std::size_t i = 0; i < sections.size(); ++i) {
    const std::size_t begin = bytes.size();
    bytes.append(sections[i]);
    bytes.resize((bytes.size() + kAlignment - 1) / kAlignment * kAlignment, '\0');
    header.sections[i] = {begin, bytes.size() - begin,
                          DigestOf(std::string_view(bytes).substr(begin))};
  }
  header.file_bytes = bytes.size();
  header.digest = DigestOf(header);
  std::memcpy(bytes.data(), &header, sizeof(Header));
  return bytes;
}

absl::Status WriteIndex(const PrimitiveIndex& index, std::string_view descriptor,
                        std::string_view about, const std::filesystem::path& path) {
  MORTISE_ASSIGN_OR_RETURN(const std::string bytes, IndexBytes(index, descriptor, about));
  return WriteFile(path, bytes);
}

absl::StatusOr<StoredIndex> ReadIndex(const std::filesystem::path& path,
                                      std::string_view descriptor) {
  MORTISE_ASSIGN_OR_RETURN(MappedFile mapped, MappedFile::Open(path));
  const auto file = std::make_shared<const MappedFile>(std::move(mapped));
  MORTISE_ASSIGN_OR_RETURN(const Header header, ReadHeader(file->bytes(), descriptor, path));
  MORTISE_RETURN_IF_ERROR(CheckSections(header, file->bytes(), path));
  std::string about;
  MORTISE_ASSIGN_OR_RETURN(const IndexArrays arrays, ArraysOf(header, file->bytes(), &about, path));
  return StoredIndex{PrimitiveIndex(arrays, file), std::move(about)};
}

}  // namespace mortise::retrieval
