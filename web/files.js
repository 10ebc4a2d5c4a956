// Files of the command: those that were dropped, read by slices, and those that it writes, in memory.
import { Directory, Fd, Inode, PreopenDirectory, wasi } from "@bjorn3/browser_wasi_shim";

// Read at once [bytes].
const SLICE = 4 << 20;

function sought(offset, whence, at, size) {
  const from = { [wasi.WHENCE_SET]: 0n, [wasi.WHENCE_CUR]: BigInt(at), [wasi.WHENCE_END]: BigInt(size) }[whence];
  const to = from === undefined ? -1n : from + offset;
  return to < 0n ? { ret: wasi.ERRNO_INVAL, offset: 0n } : { ret: wasi.ERRNO_SUCCESS, offset: to };
}

class Open extends Fd {
  at = 0;
  constructor(file, append) {
    super();
    this.file = file;
    if (append) this.at = file.size;
  }
  fd_fdstat_get() { return { ret: wasi.ERRNO_SUCCESS, fdstat: new wasi.Fdstat(wasi.FILETYPE_REGULAR_FILE, 0) }; }
  fd_filestat_get() { return { ret: wasi.ERRNO_SUCCESS, filestat: this.file.stat() }; }
  fd_tell() { return { ret: wasi.ERRNO_SUCCESS, offset: BigInt(this.at) }; }
  fd_seek(offset, whence) {
    const done = sought(offset, whence, this.at, this.file.size);
    if (done.ret === wasi.ERRNO_SUCCESS) this.at = Number(done.offset);
    return done;
  }
  fd_read(size) {
    const data = this.file.read(this.at, size);
    this.at += data.length;
    return { ret: wasi.ERRNO_SUCCESS, data };
  }
  fd_pread(size, offset) { return { ret: wasi.ERRNO_SUCCESS, data: this.file.read(Number(offset), size) }; }
  fd_write(data) {
    if (!this.file.write) return { ret: wasi.ERRNO_BADF, nwritten: 0 };
    this.file.write(this.at, data);
    this.at += data.length;
    return { ret: wasi.ERRNO_SUCCESS, nwritten: data.length };
  }
}

class Regular extends Inode {
  stat() { return new wasi.Filestat(this.ino, wasi.FILETYPE_REGULAR_FILE, BigInt(this.size)); }
}

// A file of the user's: a slice of it is in memory, never all.
export class Dropped extends Regular {
  start = 0;
  held = new Uint8Array(0);
  constructor(blob, progress) {
    super();
    this.blob = blob;
    this.progress = progress;
  }
  get size() { return this.blob.size; }
  path_open(flags, rights) {
    const writes = (rights & BigInt(wasi.RIGHTS_FD_WRITE)) !== 0n;
    return writes ? { ret: wasi.ERRNO_PERM, fd_obj: null } : { ret: wasi.ERRNO_SUCCESS, fd_obj: new Open(this, false) };
  }
  read(at, size) {
    if (at < this.start || at >= this.start + this.held.length) {
      this.held = new Uint8Array(new FileReaderSync().readAsArrayBuffer(this.blob.slice(at, at + SLICE)));
      this.start = at;
      if (this.size > 2 * SLICE) this.progress(at, this.size);
    }
    return this.held.subarray(at - this.start, at - this.start + size);
  }
}

// A file that the command writes.
export class Written extends Regular {
  size = 0;
  held = new Uint8Array(1 << 16);
  path_open(flags, rights, fdflags) {
    if (flags & wasi.OFLAGS_TRUNC) this.size = 0;
    return { ret: wasi.ERRNO_SUCCESS, fd_obj: new Open(this, fdflags & wasi.FDFLAGS_APPEND) };
  }
  read(at, size) { return this.held.slice(at, Math.min(at + size, this.size)); }
  write(at, data) {
    const end = at + data.length;
    if (end > this.held.length) {
      const larger = new Uint8Array(Math.max(end, 2 * this.held.length));
      larger.set(this.held.subarray(0, this.size));
      this.held = larger;
    }
    this.held.set(data, at);
    this.size = Math.max(this.size, end);
  }
  get bytes() { return this.held.slice(0, this.size); }
}

class Folder extends Directory {
  create_entry_for_path(path, isDirectory) {
    if (isDirectory) return super.create_entry_for_path(path, true);
    const made = super.create_entry_for_path(path, false);
    if (made.entry === null) return made;
    // The library's own files grow by a copy a write.
    const parts = path.split("/").filter(part => part && part !== ".");
    const parent = parts.slice(0, -1).reduce((folder, part) => folder.contents.get(part), this);
    const file = new Written();
    parent.contents.set(parts.at(-1), file);
    return { ret: made.ret, entry: file };
  }
}

// The working folder of the command.
export function workingFolder() {
  const preopened = new PreopenDirectory(".", new Map());
  preopened.dir = new Folder(new Map());
  return preopened;
}

// A file of the folder by its path, `undefined` if it is missing.
export function found(folder, path) {
  return path.split("/").reduce((at, part) => at?.contents?.get(part), folder.dir);
}

// Puts a file there, with the folders that lead to it.
export function put(folder, path, file) {
  const parts = path.split("/"), name = parts.pop();
  const parent = parts.reduce((at, part) => {
    if (!at.contents.has(part)) at.contents.set(part, new Folder(new Map()));
    return at.contents.get(part);
  }, folder.dir);
  parent.contents.set(name, file);
}
