!> Symmetric positive definite systems of bodies with three freedoms each in the plane or six in space, coupled pair by
!> pair: an order that keeps the couplings near the diagonal, and Cholesky factors within the envelope ("skyline") of
!> the matrix.
!>
!> Order: reverse Cuthill-McKee (George and Liu 1981, ch. 4). A chain of blocks has an envelope of two bodies, a wall
!> one of about its shorter side.
!>
!> CHOLMOD takes 14 times as long for an arch, 2 to 4 times for walls and vaults; c/sparse/band.c takes half as long,
!> with other last digits (`meson test --benchmark -C build/cp311 --verbose`).
module nonsmooth_skyline
   use common_kinds, only : wp
   use common_status, only : status_ok, status_out_of_memory, status_singular
   use nonsmooth_c_bindings, only : extrados_envelope_rows
   use, intrinsic :: iso_c_binding, only : c_int, c_int32_t
   implicit none
   private
   public :: skyline, skyline_new, skyline_add, skyline_factor, skyline_solve

   !> Row i holds the entries (i, first(i)) to (i, i) of the lower triangle, at a(start(i) + column)
   type :: skyline
      integer :: n = 0
      integer :: freedoms = 0               !! of a body
      integer(c_int32_t), allocatable :: first(:)
      integer(c_int32_t), allocatable :: start(:)
      real(wp), allocatable :: a(:)
      integer, allocatable :: rank(:)       !! place of each node in the order
   end type skyline

contains

   !> Room for a matrix of `nodes` bodies and links between them, empty
   subroutine skyline_new(nodes, freedoms, link, matrix, status)
      integer, intent(in) :: nodes
      integer, intent(in) :: freedoms           !! of a body
      integer, intent(in) :: link(:, :)         !! (2, links) nodes that are coupled
      type(skyline), intent(out) :: matrix
      integer(c_int), intent(out) :: status
      integer :: k, i, low, high, failed

      status = status_out_of_memory
      matrix%n = freedoms * nodes
      matrix%freedoms = freedoms
      allocate (matrix%first(matrix%n), matrix%start(matrix%n), matrix%rank(nodes), stat=failed)
      if (failed /= 0) return
      call order_nodes(nodes, link, matrix%rank, status)
      if (status /= status_ok) return
      do i = 1, matrix%n
         matrix%first(i) = i - mod(i - 1, freedoms)
      end do
      do k = 1, size(link, 2)
         low = minval(matrix%rank(link(:, k)))
         high = maxval(matrix%rank(link(:, k)))
         do i = freedoms * (high - 1) + 1, freedoms * high
            matrix%first(i) = min(matrix%first(i), freedoms * (low - 1) + 1)
         end do
      end do
      k = 0
      do i = 1, matrix%n
         matrix%start(i) = k - matrix%first(i) + 1
         k = k + i - matrix%first(i) + 1
      end do
      status = status_out_of_memory
      allocate (matrix%a(k), stat=failed)
      if (failed /= 0) return
      matrix%a = 0.0_wp
      status = status_ok
   end subroutine skyline_new

   !> Reverse Cuthill-McKee: from an end of each part that hangs together, neighbours of few links first
   subroutine order_nodes(nodes, link, rank, status)
      integer, intent(in) :: nodes
      integer, intent(in) :: link(:, :)
      integer, intent(out) :: rank(:)           !! (nodes)
      integer(c_int), intent(out) :: status
      integer, allocatable :: row(:), beside(:), queue(:)
      logical, allocatable :: seen(:)
      integer :: k, i, node, done, failed

      status = status_out_of_memory
      allocate (row(nodes + 1), beside(2 * size(link, 2)), queue(nodes), seen(nodes), stat=failed)
      if (failed /= 0) return
      row = 0
      do k = 1, size(link, 2)
         do i = 1, 2
            row(link(i, k)) = row(link(i, k)) + 1
         end do
      end do
      row(nodes + 1) = 1 + 2 * size(link, 2)
      do i = nodes, 1, -1
         row(i) = row(i + 1) - row(i)
      end do
      queue(:) = row(1:nodes)                   ! where the next neighbour of each node goes
      do k = 1, size(link, 2)
         do i = 1, 2
            node = link(i, k)
            beside(queue(node)) = link(3 - i, k)
            queue(node) = queue(node) + 1
         end do
      end do
      seen = .false.
      done = 0
      do while (done < nodes)
         node = 0
         do i = 1, nodes
            if (seen(i)) cycle
            if (node == 0) node = i
            if (degree(i) < degree(node)) node = i
         end do
         ! The last node of a walk from anywhere is at an end of its part.
         k = done
         call walk_levels(node, k)
         node = queue(k)
         seen(queue(done + 1:k)) = .false.
         call walk_levels(node, done)
      end do
      do k = 1, nodes
         rank(queue(k)) = nodes + 1 - k
      end do
      status = status_ok

   contains

      integer pure function degree(at)
         integer, intent(in) :: at
         degree = row(at + 1) - row(at)
      end function degree

      !> Nodes that hang on `from`, level by level, into the queue
      subroutine walk_levels(from, last)
         integer, intent(in) :: from
         integer, intent(inout) :: last
         integer :: head, n, at, moving, place
         last = last + 1
         queue(last) = from
         seen(from) = .true.
         head = last
         do while (head <= last)
            at = last + 1
            do n = row(queue(head)), row(queue(head) + 1) - 1
               if (seen(beside(n))) cycle
               seen(beside(n)) = .true.
               last = last + 1
               moving = beside(n)
               place = last
               do while (place > at)
                  if (degree(queue(place - 1)) <= degree(moving)) exit
                  queue(place) = queue(place - 1)
                  place = place - 1
               end do
               queue(place) = moving
            end do
            head = head + 1
         end do
      end subroutine walk_levels

   end subroutine order_nodes

   !> Add a symmetric matrix of the freedoms of two bodies, of which one may be prescribed
   pure subroutine skyline_add(matrix, rank, block)
      type(skyline), intent(inout) :: matrix
      integer, intent(in) :: rank(2)             !! of the bodies, 0 where one is prescribed
      real(wp), intent(in) :: block(2 * matrix%freedoms, 2 * matrix%freedoms)
      integer :: i, j, side, row, column, at, beside, n
      n = matrix%freedoms
      do side = 1, 2
         if (rank(side) == 0) cycle
         at = n * (side - 1)
         do i = 1, n
            row = n * (rank(side) - 1) + i
            column = matrix%start(row) + n * (rank(side) - 1)
            do j = 1, i
               matrix%a(column + j) = matrix%a(column + j) + block(at + j, at + i)
            end do
         end do
      end do
      if (any(rank == 0)) return
      side = maxloc(rank, dim=1)                 ! whose rows hold what couples them
      at = n * (side - 1)
      beside = n - at
      do i = 1, n
         row = n * (rank(side) - 1) + i
         column = matrix%start(row) + n * (minval(rank) - 1)
         do j = 1, n
            matrix%a(column + j) = matrix%a(column + j) + block(beside + j, at + i)
         end do
      end do
   end subroutine skyline_add

   !> Cholesky factors in place of the matrix; singular where it is not positive definite, invalid_argument where bodies have other than
   !> 3 or 6 freedoms. The rows of a body meet all rows above together
   pure subroutine skyline_factor(matrix, status)
      type(skyline), intent(inout) :: matrix
      integer(c_int), intent(out) :: status
      integer :: i, j, from, other, body
      real(wp) :: pivot

      do i = 1, matrix%n
         body = i - mod(i - 1, matrix%freedoms)
         if (i == body) then
            call extrados_envelope_rows(matrix%freedoms, i, matrix%first, matrix%start, matrix%a, status)
            if (status /= status_ok) return
            status = status_singular
         end if
         associate (a => matrix%a, row => matrix%start(i), first => matrix%first(i))
            do j = body, i - 1
               from = max(first, matrix%first(j))
               other = matrix%start(j)
               a(row + j) = (a(row + j) - dot(a(row + from:row + j - 1), a(other + from:other + j - 1))) / a(other + j)
            end do
            pivot = a(row + i) - dot(a(row + first:row + i - 1), a(row + first:row + i - 1))
            if (.not. pivot > 0.0_wp) return
            a(row + i) = sqrt(pivot)
         end associate
      end do
      status = status_ok
   end subroutine skyline_factor

   !> Solve with the factors: right-hand side in, solution out
   pure subroutine skyline_solve(matrix, x)
      type(skyline), intent(in) :: matrix
      real(wp), intent(inout), contiguous :: x(:)
      integer :: i
      do i = 1, matrix%n
         associate (row => matrix%start(i), first => matrix%first(i))
            x(i) = (x(i) - dot(matrix%a(row + first:row + i - 1), x(first:i - 1))) / matrix%a(row + i)
         end associate
      end do
      do i = matrix%n, 1, -1
         associate (row => matrix%start(i), first => matrix%first(i))
            x(i) = x(i) / matrix%a(row + i)
            x(first:i - 1) = x(first:i - 1) - x(i) * matrix%a(row + first:row + i - 1)
         end associate
      end do
   end subroutine skyline_solve

   !> Dot product in four sums: they do not wait for each other
   pure function dot(x, y) result(total)
      real(wp), intent(in), contiguous :: x(:)
      real(wp), intent(in), contiguous :: y(:)
      real(wp) :: total
      real(wp) :: s1, s2, s3, s4
      integer :: k, n
      n = size(x)
      s1 = 0.0_wp
      s2 = 0.0_wp
      s3 = 0.0_wp
      s4 = 0.0_wp
      do k = 1, n - 3, 4
         s1 = s1 + x(k) * y(k)
         s2 = s2 + x(k + 1) * y(k + 1)
         s3 = s3 + x(k + 2) * y(k + 2)
         s4 = s4 + x(k + 3) * y(k + 3)
      end do
      do k = n - mod(n, 4) + 1, n
         s1 = s1 + x(k) * y(k)
      end do
      total = (s1 + s2) + (s3 + s4)
   end function dot

end module nonsmooth_skyline
