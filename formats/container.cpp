#include "formats/container.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>

namespace tet4d::container {
namespace {

constexpr unsigned char kMagic[8] = {'T', '4', 'D', '\r', '\n', 0x1A, '\n', 0};
constexpr std::array<std::byte, kPageAlignment> kZeros{};

Fault writeFault(const std::string& path, const char* doing, int error) {
  const bool full = error == ENOSPC || error == EDQUOT || error == EFBIG;
  return {
      full ? FaultCode::kNoSpace : FaultCode::kIo, path, "",
      std::string("cannot ") + doing + ": " + std::strerror(error),
      full ? "free some space or write elsewhere; nothing was left behind" : "check the folder and its permissions"};
}

// A new file beside `path`, with the permissions any new file gets; its name in `name`. Negative: errno says why.
int createBeside(const std::string& path, std::string& name) {
  // Files of runs that were killed may still be there: take the first free number.
  for (int number = 0; number < 1000; ++number) {
    name = path + ".partial-" + std::to_string(::getpid()) + "-" + std::to_string(number);
    const int fd = ::open(name.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (fd >= 0 || errno != EEXIST) return fd;
  }
  return -1;
}

}  // namespace

struct Writer::State {
  std::string path, temporary;
  int fd = -1;
  bool force = false;
  bool in_pages = false;
  FileHeader header{};
  std::uint64_t position = 0;  // bytes written so far
  std::vector<SectionEntry> sections;

  State() = default;
  State(const State&) = delete;
  State& operator=(const State&) = delete;
  ~State() {
    if (fd >= 0) ::close(fd);
    if (!temporary.empty()) ::unlink(temporary.c_str());
  }

  Status put(std::span<const std::byte> bytes) {
    while (!bytes.empty()) {
      const ssize_t n = ::write(fd, bytes.data(), bytes.size());
      if (n < 0 && errno == EINTR) continue;
      if (n < 0) return writeFault(path, "write", errno);
      position += static_cast<std::uint64_t>(n);
      bytes = bytes.subspan(static_cast<std::size_t>(n));
    }
    return {};
  }
  Status align(std::size_t alignment) {
    const std::size_t over = position % alignment;
    return over == 0 ? Status{} : put(std::span(kZeros).first(alignment - over));
  }
};

Writer::Writer(std::unique_ptr<State> state) : state_(std::move(state)) {}
Writer::~Writer() = default;
Writer::Writer(Writer&&) noexcept = default;
Writer& Writer::operator=(Writer&&) noexcept = default;

Result<Writer> Writer::create(const std::string& path, std::uint32_t payload, std::uint16_t payload_version,
                              bool force) {
  if (path.empty() || path == "-") {
    return Fault{FaultCode::kUsage, path, "", "a container cannot be written to standard output",
                 "name a file with -o"};
  }
  // A container is made beside its name and renamed to it: what is no file would be replaced by one.
  struct stat info {};
  if (::stat(path.c_str(), &info) == 0 && !S_ISREG(info.st_mode)) {
    return Fault{FaultCode::kUsage, path, "",
                 "is a directory, device or pipe, and a container can only be a regular file", "name a regular file"};
  }
  if (!force && ::access(path.c_str(), F_OK) == 0) {
    return Fault{FaultCode::kIo, path, "", "exists and is kept", "remove it, choose another name, or pass --force"};
  }
  auto state = std::make_unique<State>();
  state->path = path;
  state->force = force;
  std::string name;
  state->fd = createBeside(path, name);
  if (state->fd < 0) return writeFault(path, "create", errno);
  state->temporary = name;
  std::memcpy(state->header.magic, kMagic, sizeof kMagic);
  state->header.endian_mark = 0x01020304;
  state->header.container_version = kContainerVersion;
  state->header.payload = payload;
  state->header.payload_version = payload_version;
  // The header's place is taken now and its content written last: a file cut short has no valid header.
  if (Status status = state->put(std::span(kZeros).first(sizeof(FileHeader))); !status.ok()) return status.fault();
  return Writer(std::move(state));
}

Status Writer::add(std::uint32_t kind, std::uint32_t flags, std::size_t item_bytes,
                   std::span<const std::byte> content) {
  if (Status status = state_->align(kAlignment); !status.ok()) return status;
  SectionEntry entry{};
  entry.kind = kind;
  entry.flags = flags;
  entry.offset = state_->position;
  entry.bytes = content.size();
  entry.item_bytes = static_cast<std::uint32_t>(item_bytes);
  entry.item_count = content.size() / item_bytes;
  entry.xxh3 = xxh3(content);
  state_->sections.push_back(entry);
  return state_->put(content);
}

Status Writer::beginPages(std::uint32_t kind, std::uint32_t flags) {
  if (Status status = state_->align(kPageAlignment); !status.ok()) return status;
  SectionEntry entry{};
  entry.kind = kind;
  entry.flags = flags | kSectionPaged;
  entry.offset = state_->position;
  entry.item_bytes = 1;
  state_->sections.push_back(entry);
  state_->in_pages = true;
  return {};
}

Result<std::uint64_t> Writer::appendPage(std::span<const std::byte> bytes) {
  assert(state_->in_pages);
  if (Status status = state_->align(kPageAlignment); !status.ok()) return status.fault();
  const std::uint64_t offset = state_->position;
  if (Status status = state_->put(bytes); !status.ok()) return status.fault();
  return offset;
}

Status Writer::continuePage(std::span<const std::byte> bytes) {
  assert(state_->in_pages);
  return state_->put(bytes);
}

Status Writer::endPages() {
  assert(state_->in_pages);
  state_->in_pages = false;
  SectionEntry& entry = state_->sections.back();
  entry.bytes = state_->position - entry.offset;
  entry.item_count = entry.bytes;
  return {};
}

Status Writer::close() {
  State& s = *state_;
  assert(!s.in_pages);
  if (s.fd < 0) return Fault{FaultCode::kUsage, s.path, "", "the file is closed already", ""};
  if (Status status = s.align(kAlignment); !status.ok()) return status;
  s.header.table_offset = s.position;
  s.header.section_count = static_cast<std::uint32_t>(s.sections.size());
  const auto table = std::as_bytes(std::span(s.sections));
  s.header.table_xxh3 = xxh3(table);
  if (Status status = s.put(table); !status.ok()) return status;
  s.header.file_bytes = s.position;
  const auto header = std::as_bytes(std::span(&s.header, 1));
  s.header.header_xxh3 = xxh3(header.first(offsetof(FileHeader, header_xxh3)));
  if (::pwrite(s.fd, &s.header, sizeof s.header, 0) != static_cast<ssize_t>(sizeof s.header)) {
    return writeFault(s.path, "write the header", errno);
  }
  const int closed = ::close(s.fd);
  s.fd = -1;
  if (closed != 0) return writeFault(s.path, "finish", errno);
  int renamed = -1;
  if (s.force) {
    renamed = std::rename(s.temporary.c_str(), s.path.c_str());
  } else {
    renamed = ::renameat2(AT_FDCWD, s.temporary.c_str(), AT_FDCWD, s.path.c_str(), RENAME_NOREPLACE);
    if (renamed != 0 && (errno == EINVAL || errno == ENOSYS)) {  // not every file system can refuse to replace
      renamed = ::link(s.temporary.c_str(), s.path.c_str());
      if (renamed == 0) ::unlink(s.temporary.c_str());
    }
  }
  if (renamed != 0) return writeFault(s.path, "rename the finished file", errno);
  s.temporary.clear();
  return {};
}

std::uint64_t Writer::bytesWritten() const { return state_->position; }

const std::string& Writer::path() const { return state_->path; }

}  // namespace tet4d::container
