!> Factor and solution of the stiffness of bodies that touch: skyline.f90 against c/sparse/band.c and CHOLMOD, on one
!> matrix, by processor time. `meson test --benchmark -C build/cp311 --verbose` runs it.
program bench_factors
   use common_kinds, only : wp
   use common_status, only : status_ok
   use limit_c_bindings, only : extrados_band_factor, extrados_band_solve
   use nonsmooth_skyline, only : skyline, skyline_add, skyline_factor, skyline_new, skyline_solve
   use sla_c_bindings, only : extrados_sparse_free, extrados_sparse_new, extrados_sparse_order, extrados_sparse_plain
   use, intrinsic :: iso_c_binding, only : c_int, c_int64_t, c_null_ptr, c_ptr
   implicit none (type, external)
   integer, parameter :: runs = 5
   integer(c_int) :: status

   call compare('arch of 60 voussoirs', 1, 60, 3)
   call compare('wall of 12 courses of 8 blocks', 12, 8, 3)
   call compare('wall of 40 courses of 25 blocks', 40, 25, 3)
   call compare('vault of 30 rings of 12 blocks in space', 30, 12, 6)

contains

   !> Courses of blocks that each touch the next one and two of the course below
   subroutine compare(name, courses, columns, freedoms)
      character(*), intent(in) :: name
      integer, intent(in) :: courses, columns, freedoms
      type(skyline) :: matrix, kept
      integer, allocatable :: link(:, :)
      real(wp), allocatable :: dense(:, :), band(:, :), band_kept(:, :), x(:), y(:), z(:, :), right(:)
      real(wp) :: block(2 * freedoms, 2 * freedoms), spent(3, runs), begin, end
      integer :: i, j, k, n, links, width, times, run, t
      integer(c_int64_t), allocatable :: start(:), row(:), order(:)
      real(wp), allocatable :: value(:)
      type(c_ptr) :: handle
      integer(c_int64_t) :: values

      allocate (link(2, 3 * courses * columns))
      links = 0
      do i = 0, courses - 1
         do j = 1, columns
            k = i * columns + j
            if (j < columns) call join(k, k + 1, link, links)
            if (i == 0) cycle
            call join(k - columns, k, link, links)
            if (j > 1) call join(k - columns - 1, k, link, links)
         end do
      end do
      n = freedoms * courses * columns
      call skyline_new(courses * columns, freedoms, link(:, :links), kept, status)
      if (status /= status_ok) error stop 'no skyline'
      allocate (dense(n, n), right(n), x(n), y(n), z(n, 1))
      call random_init(.true., .true.)
      call random_number(right)
      do k = 1, courses * columns
         call random_number(block)
         block = matmul(transpose(block), block)
         do i = 1, freedoms
            block(i, i) = block(i, i) + 10.0_wp
         end do
         call skyline_add(kept, [k, 0], block)
      end do
      do k = 1, links
         call random_number(block)
         block = matmul(transpose(block), block)
         call skyline_add(kept, kept%rank(link(:, k)), block)
      end do
      dense = 0.0_wp
      width = 0
      do i = 1, n
         width = max(width, i - kept%first(i))
         dense(i, kept%first(i):i) = kept%a(kept%start(i) + kept%first(i):kept%start(i) + i)
      end do
      allocate (band(width + 1, n), band_kept(width + 1, n))
      band_kept = 0.0_wp
      do j = 1, n
         do i = j, min(n, j + width)
            band_kept(i - j + 1, j) = dense(i, j)
         end do
      end do
      call pattern_of(dense, [(int(i - 1, c_int64_t), i=1, n)], start, row, value)
      allocate (order(n))
      status = extrados_sparse_order(int(n, c_int64_t), start, row, 0_c_int, order)
      call pattern_of(dense, order, start, row, value)
      handle = c_null_ptr
      status = extrados_sparse_new(int(n, c_int64_t), start, row, handle, values)
      if (status /= status_ok) error stop 'no factor'
      times = max(1, int(2.0e7_wp / (real(n, wp) * real(width, wp)**2)))
      do run = 1, runs
         call cpu_time(begin)
         do t = 1, times
            matrix = kept
            call skyline_factor(matrix, status)
            x(:) = right
            call skyline_solve(matrix, x)
         end do
         call cpu_time(end)
         spent(1, run) = end - begin
         begin = end
         do t = 1, times
            band(:, :) = band_kept
            status = extrados_band_factor(int(n, c_int64_t), int(width, c_int64_t), band)
            y(:) = right
            call extrados_band_solve(int(n, c_int64_t), int(width, c_int64_t), band, y)
         end do
         call cpu_time(end)
         spent(2, run) = end - begin
         begin = end
         do t = 1, times
            z(:, 1) = right(order + 1)
            status = extrados_sparse_plain(handle, value, 1_c_int, z)
         end do
         call cpu_time(end)
         spent(3, run) = end - begin
      end do
      call extrados_sparse_free(handle)
      if (maxval(abs(x - y)) > 1.0e-8_wp * maxval(abs(x))) error stop 'the band has another solution'
      if (maxval(abs(x(order + 1) - z(:, 1))) > 1.0e-8_wp * maxval(abs(x))) error stop 'CHOLMOD has another solution'
      print '(2a, i0, a, f9.4, 2(a, f6.2))', name, ', ', n, ' equations: skyline', &
         1.0e3_wp * middle(spent(1, :)) / real(times, wp), ' ms; over it band.c', &
         middle(spent(2, :)) / middle(spent(1, :)), ', CHOLMOD', middle(spent(3, :)) / middle(spent(1, :))
   end subroutine compare

   subroutine join(one, other, link, links)
      integer, intent(in) :: one, other
      integer, intent(inout) :: link(:, :)
      integer, intent(inout) :: links
      links = links + 1
      link(:, links) = [one, other]
   end subroutine join

   !> Lower triangle by columns of a matrix whose equations stand in another order, 0-based
   subroutine pattern_of(dense, order, start, row, value)
      real(wp), intent(in) :: dense(:, :)          !! its lower triangle
      integer(c_int64_t), intent(in) :: order(:)   !! order(new) = old, 0-based
      integer(c_int64_t), allocatable, intent(out) :: start(:), row(:)
      real(wp), allocatable, intent(out) :: value(:)
      integer :: i, j, n, low, high
      integer(c_int64_t) :: count
      n = size(order)
      allocate (start(n + 1), row(n * n / 2 + n), value(n * n / 2 + n))
      count = 0
      do j = 1, n
         start(j) = count
         do i = j, n
            low = int(min(order(i), order(j))) + 1
            high = int(max(order(i), order(j))) + 1
            if (i > j .and. .not. abs(dense(high, low)) > 0.0_wp) cycle
            count = count + 1
            row(count) = i - 1
            value(count) = dense(high, low)
         end do
      end do
      start(n + 1) = count
   end subroutine pattern_of

   !> Median of the runs
   pure function middle(values) result(found)
      real(wp), intent(in) :: values(runs)
      real(wp) :: found
      integer :: i
      found = values(1)
      do i = 1, runs
         if (2 * count(values < values(i)) <= runs .and. 2 * count(values > values(i)) <= runs) found = values(i)
      end do
   end function middle

end program bench_factors
