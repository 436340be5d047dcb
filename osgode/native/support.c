/* What everything else in C stands on: assertions and messages, memory, random numbers. */

#define _GNU_SOURCE /* RTLD_NOLOAD */
#include <dlfcn.h>
#include <stdarg.h>
#include <stdio.h>

#include "internal.h"

/* ------------------------------------------------------------------ assertions and messages */

__thread struct guard guard;

enum { MESSAGES = 64, MESSAGE_SIZE = 400 };
static struct {
    pthread_mutex_t lock;
    char text[MESSAGES][MESSAGE_SIZE];
    unsigned int first, count;
} messages = {.lock = PTHREAD_MUTEX_INITIALIZER};

/* ODE pastes the asserted expression into the format unescaped, so a bare % may stand there: only the
   conversions that ODE itself uses are followed, everything else is copied. */
static void copy_text(char *out, size_t size, const char *format, va_list args) {
    size_t used = 0;
    for (const char *c = format; *c && used + 1 < size;) {
        int wrote = -1;
        if (c[0] == '%') {
            if (c[1] == 's')
                wrote = snprintf(out + used, size - used, "%s", va_arg(args, const char *));
            else if (c[1] == 'd' || c[1] == 'i')
                wrote = snprintf(out + used, size - used, "%d", va_arg(args, int));
            else if (c[1] == 'u')
                wrote = snprintf(out + used, size - used, "%u", va_arg(args, unsigned int));
            else if (strncmp(c, "%.4e", 4) == 0)
                wrote = snprintf(out + used, size - used, "%g", va_arg(args, double));
        }
        if (wrote >= 0) {
            used += (size_t)wrote;
            c += c[1] == '.' ? 4 : 2;
        } else {
            out[used++] = *c++;
        }
    }
    out[used < size ? used : size - 1] = 0;
}

static void keep_message(const char *text) {
    pthread_mutex_lock(&messages.lock);
    snprintf(messages.text[(messages.first + messages.count) % MESSAGES], MESSAGE_SIZE, "%s", text);
    if (messages.count < MESSAGES)
        messages.count++;
    else
        messages.first = (messages.first + 1) % MESSAGES;
    pthread_mutex_unlock(&messages.lock);
}

static void on_failure(int number, const char *format, va_list args) {
    (void)number;
    copy_text(guard.text, sizeof guard.text, format, args);
    keep_message(guard.text);
    if (guard.armed) longjmp(guard.place, 1);
}

static void on_message(int number, const char *format, va_list args) {
    (void)number;
    char text[MESSAGE_SIZE];
    copy_text(text, sizeof text, format, args);
    keep_message(text);
}

const char *oo_last_error(void) { return guard.text; }

int oo_take_message(char *text, unsigned int size) {
    int taken = 0;
    pthread_mutex_lock(&messages.lock);
    if (messages.count) {
        snprintf(text, size, "%s", messages.text[messages.first]);
        messages.first = (messages.first + 1) % MESSAGES;
        messages.count--;
        taken = 1;
    }
    pthread_mutex_unlock(&messages.lock);
    return taken;
}

/* ------------------------------------------------------------------ memory */

oo_live live;

/* In each step ODE walks lists of its bodies, geoms and joints. Where malloc puts them is where Python's heap has
   gaps, all over it: a step of 340 geoms took 1.2 times as long as in plain C. So small blocks are cut from slabs,
   one after the other, and one that is freed waits in the list of its size. Slabs are never given back. Blocks
   begin with a cache line: where they begin 48 bytes later, the same step takes 1.06 times as long. */
enum { LINE = 64, SLAB = 1 << 18 };
#ifdef __SANITIZE_ADDRESS__
enum { SMALL = 0 }; /* so that the sanitizer sees each block */
#else
enum { SMALL = 2048 };
#endif

typedef struct header { /* stands in the line before its block */
    size_t size;           /* as it was asked for: a quadtree says another when it frees */
    struct header *next;   /* while it is free */
} header;
_Static_assert(sizeof(header) == 16, "blocks from malloc would not be aligned");

static struct {
    pthread_mutex_t lock;
    char *at;
    size_t left;
    header *freed[SMALL / LINE + 2]; /* by size with header, in lines */
} slab = {.lock = PTHREAD_MUTEX_INITIALIZER};

/* How many lines a block of that size takes; 0: it comes from malloc. */
static size_t lines_of(size_t size) { return size < SMALL ? (sizeof(header) + size + LINE - 1) / LINE : 0; }

static header *cut_block(size_t size) {
    if (slab.left < size) {
        char *fresh = aligned_alloc(LINE, SLAB);
        if (!fresh) return NULL;
        slab.at = fresh + LINE - sizeof(header);
        slab.left = SLAB - LINE + sizeof(header);
    }
    header *cut = (header *)slab.at;
    slab.at += size;
    slab.left -= size;
    return cut;
}

static void *take_block(size_t size) {
    size_t lines = lines_of(size);
    header *taken;
    if (lines) {
        pthread_mutex_lock(&slab.lock);
        taken = slab.freed[lines];
        if (taken)
            slab.freed[lines] = taken->next;
        else
            taken = cut_block(LINE * lines);
        pthread_mutex_unlock(&slab.lock);
    } else {
        taken = malloc(sizeof *taken + size);
    }
    if (!taken) return NULL;
    taken->size = size;
    return taken + 1;
}

static void give_block(void *given) {
    if (!given) return;
    header *old = (header *)given - 1;
    size_t lines = lines_of(old->size);
    if (lines) {
        pthread_mutex_lock(&slab.lock);
        old->next = slab.freed[lines];
        slab.freed[lines] = old;
        pthread_mutex_unlock(&slab.lock);
    } else {
        free(old);
    }
}

static size_t size_of(const void *block) { return block ? ((const header *)block - 1)->size : 0; }

static void *counted_alloc(dsizeint size) {
    void *block = take_block(size);
    if (block) {
        count_live(&live.blocks, 1);
        count_live(&live.bytes, (long)size);
    }
    return block;
}

/* Not counted as a block: only caches that ODE keeps for good begin with NULL here. */
static void *counted_realloc(void *old, dsizeint old_size, dsizeint size) {
    (void)old_size;
    size_t held = size_of(old);
    void *block = take_block(size);
    if (!block) return NULL;
    if (old) memcpy(block, old, held < size ? held : size);
    give_block(old);
    count_live(&live.bytes, (long)size - (long)held);
    return block;
}

static void counted_free(void *block, dsizeint size) {
    (void)size;
    if (block) {
        count_live(&live.blocks, -1);
        count_live(&live.bytes, -(long)size_of(block));
    }
    give_block(block);
}

oo_live oo_count_live(void) { return live; }

/* What is large grows by a quarter: with thousands of bodies half of the tables would stand empty otherwise. */
enum { PLENTY_OF_BYTES = 1 << 16 };

int reserve(void *array, unsigned int *capacity, size_t wanted, size_t element) {
    if (wanted <= *capacity) return OO_OK;
    size_t grown = *capacity ? *capacity : 16;
    while (grown < wanted) grown += grown * element < PLENTY_OF_BYTES ? grown : grown / 4;
    void **place = array;
    void *moved = realloc(*place, grown * element);
    if (!moved) return OO_NO_MEMORY;
    *place = moved;
    *capacity = (unsigned int)grown;
    return OO_OK;
}

/* ------------------------------------------------------------------ random numbers

   The quick step draws the order of its rows from one sequence for the whole process. This dRand takes the
   place of libode's (the dynamic linker looks here first) with a seed per thread, which is loaded from the
   World before a step and stored back after it. Where libode was loaded before us it keeps its own, and a lock must do. */

static __thread unsigned long thread_seed;
static int random_is_local;
static pthread_mutex_t random_lock = PTHREAD_MUTEX_INITIALIZER;
static void (*shared_set_seed)(unsigned long);
static unsigned long (*shared_get_seed)(void);

unsigned long dRand(void) { /* the generator of libode: Numerical Recipes' ranqd1 */
    thread_seed = (1664525UL * thread_seed + 1013904223UL) & 0xffffffffUL;
    return thread_seed;
}

static int find_random(void) {
    thread_seed = 1;
    dRandInt(1000);
    random_is_local = thread_seed != 1;
    if (random_is_local) return OO_OK;
    void *libode = dlopen("libode.so.8", RTLD_LAZY | RTLD_NOLOAD);
    if (!libode) return OO_ASSERT;
    *(void **)&shared_set_seed = dlsym(libode, "dRandSetSeed");
    *(void **)&shared_get_seed = dlsym(libode, "dRandGetSeed");
    return shared_set_seed && shared_get_seed ? OO_OK : OO_ASSERT;
}

int oo_random_is_local(void) { return random_is_local; }

void random_begin(const oo_world *w) {
    if (random_is_local) {
        thread_seed = w->seed;
    } else {
        pthread_mutex_lock(&random_lock);
        shared_set_seed(w->seed);
    }
}

void random_end(oo_world *w) {
    if (random_is_local) {
        w->seed = thread_seed;
    } else {
        w->seed = shared_get_seed();
        pthread_mutex_unlock(&random_lock);
    }
}

int oo_init(void) {
    dSetErrorHandler(on_failure);
    dSetDebugHandler(on_failure);
    dSetMessageHandler(on_message);
    if (find_random() != OO_OK) return OO_ASSERT;
    if (random_is_local) { /* else somebody used libode before us, and may free with our handlers what he got from his */
        dSetAllocHandler(counted_alloc);
        dSetReallocHandler(counted_realloc);
        dSetFreeHandler(counted_free);
    }
    if (!dInitODE2(0) || !dAllocateODEDataForThread(dAllocateMaskAll)) return OO_ASSERT;
    if (guard_enter()) return OO_ASSERT; /* somebody in this process has made as many geom classes as ODE has room for */
    init_heightfields();
    guard_leave();
    oo_world *first = oo_world_new();
    if (!first) return OO_ASSERT;
    dGeomDestroy(dCreateSphere(0, 1)); /* leaves one block in ODE's cache of geom positions */
    oo_world_free(first);
    live = (oo_live){0}; /* what ODE keeps for good since its first world is not ours to count */
    return OO_OK;
}
