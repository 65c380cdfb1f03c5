// A .vdb file as bytes: what can be known of it before OpenVDB, which trusts what it reads, sees
// it.
#pragma once

#include <cstdint>
#include <exception>
#include <string>
#include <vector>

namespace estara {

/// File metadata under which a file carries the digest of its own bytes, 16 hex digits.
inline constexpr const char* digest_key = "estara_digest";
inline constexpr const char* digest_placeholder = "0000000000000000";

struct VdbLayout {
    std::uint64_t size = 0;          ///< of the file, bytes
    std::uint64_t needed = 0;        ///< more than size: cut short, and what follows is incomplete
    std::uint64_t digest_at = 0;     ///< where the digest's 16 characters are; 0: there is none
    std::vector<std::string> grids;  ///< names, in file order
};

/// Reads the header and the list of grids. Any length or position in them that points outside the
/// file ends the reading, so this takes little memory whatever the bytes are.
/// Error: no such file, empty, not a .vdb, a format older or newer than OpenVDB 10 writes, cut
/// inside the header's own fields.
VdbLayout vdb_layout(const std::string& path);

/// Throws unless the file is whole and its digest, if it has one, is that of its bytes.
/// @return  its layout
VdbLayout check_vdb_bytes(const std::string& path);

/// Puts the digest in place of the placeholder. Error (failed) if the file cannot be written.
void seal_vdb(const std::string& path, const VdbLayout& layout);

/// First line of a text that comes from elsewhere, at most 200 characters; '?' for all but
/// printable ASCII.
std::string clamped(const std::string& text);

/// What an exception of OpenVDB says, clamped, without the name of its class in front.
std::string reason(const std::exception& e);

}  // namespace estara
