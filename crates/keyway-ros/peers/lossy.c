/* Loses a part of the packets that a program sends: LD_PRELOAD it, with LOSS as the part in percent.
   For machines whose kernel has no netem. */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <stdint.h>
#include <stdlib.h>
#include <sys/socket.h>
#include <sys/uio.h>

static int is_lost(int socket) {
    static _Atomic uint64_t state = 88172645463325252u;
    static int percent = -1;
    if (percent < 0) {
        const char *loss = getenv("LOSS");
        percent = loss ? atoi(loss) : 0;
    }
    int type = 0;
    socklen_t size = sizeof type;
    if (getsockopt(socket, SOL_SOCKET, SO_TYPE, &type, &size) != 0 || type != SOCK_DGRAM) return 0;
    uint64_t next = state * 6364136223846793005u + 1442695040888963407u;
    state = next;
    return (int)((next >> 33) % 100) < percent;
}

ssize_t sendto(int socket, const void *data, size_t size, int flags, const struct sockaddr *to, socklen_t to_size) {
    static ssize_t (*real)(int, const void *, size_t, int, const struct sockaddr *, socklen_t);
    if (!real) real = dlsym(RTLD_NEXT, "sendto");
    return is_lost(socket) ? (ssize_t)size : real(socket, data, size, flags, to, to_size);
}

ssize_t sendmsg(int socket, const struct msghdr *message, int flags) {
    static ssize_t (*real)(int, const struct msghdr *, int);
    if (!real) real = dlsym(RTLD_NEXT, "sendmsg");
    if (!is_lost(socket)) return real(socket, message, flags);
    ssize_t size = 0;
    for (size_t part = 0; part < message->msg_iovlen; part++) size += message->msg_iov[part].iov_len;
    return size;
}
