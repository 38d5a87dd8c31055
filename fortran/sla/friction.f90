!> Coulomb friction of all joints that slide, at once.
!>
!> Where a joint slides, its friction is proportional to the pressure across it at the same point: a stiffness that is
!> not symmetric, beside the symmetric one K that is factorised. The force f h by which the point differs from a spring
!> follows the displacements, h = r.u. The points that slide are few: with F and R the columns f and rows r of all,
!>
!>     (I - R inv(K) F) dh = R u - h,     u <- u + inv(K) F dh
!>
!> for the constant loads and those per unit multiplier alike (Woodbury's formula). So friction is exact between events.
!> The matrix R inv(K) F is kept from event to event: an event changes K by a few vectors, K_old = K + W S W', which
!> adds R Z inv(inv(S) + W' Z) Z' F with Z = inv(K) W, and one row and column at most are new.
module sla_friction
   use common_kinds, only : wp
   use common_status, only : status_ok, status_not_positive_definite, status_out_of_memory
   use sla_c_bindings, only : extrados_sparse_plain, extrados_sparse_solve
   use sla_group, only : event_vectors, group_holder, most_rank, point_group, slider
   use, intrinsic :: iso_c_binding, only : c_int, c_ptr
   implicit none
   private
   public :: friction_store, friction_balance
   public :: add_force, eliminate, find_sliders, product_of, solve

   !> Pivot of the unsymmetric system, whose diagonal is near one, below which the joints slide on without more load
   real(wp), parameter :: least_pivot = 1.0e-9_wp
   !> Right sides of one solution
   integer, parameter :: most_vectors = 4

   !> The points that slide and what they do to each other
   type :: friction_store
      logical :: known = .false.                  !! there are answers,
      logical :: current = .false.                !! and they are those of the factor as it is
      type(slider), allocatable :: point(:)
      real(wp), allocatable :: answer(:, :)       !! R inv(K) F
   end type friction_store

contains

   !> Forces of sliding friction and displacements that balance with them
   subroutine friction_balance(store, holders, event, place, handle, fresh, value, n, ua, ub, fh, &
                               status)
      type(friction_store), intent(inout) :: store
      type(group_holder), intent(inout) :: holders(:)
      type(event_vectors), intent(in) :: event !! by which the factor changed since the last balance
      integer, intent(in) :: place(2)          !! group and point of the event
      type(c_ptr), intent(in) :: handle        !! of the factor
      logical, intent(in) :: fresh             !! solve with a new factor of `value`
      real(wp), intent(in) :: value(:)         !! of the stiffness
      integer, intent(in) :: n                 !! equations
      real(wp), intent(inout) :: ua(0:)        !! under the constant loads; beyond n supports that move [m]
      real(wp), intent(inout) :: ub(0:)        !! per unit multiplier [m]
      real(wp), intent(inout) :: fh(0:, :)     !! (0:, 2) forces of friction, constant and per unit multiplier [N]
      integer(c_int), intent(out) :: status    !! not_positive_definite: what slides is a mechanism; nothing was changed
      type(slider), allocatable :: point(:)
      real(wp), allocatable :: coupling(:, :), change(:, :), force(:, :)
      integer :: i, j, m, info

      call find_sliders(holders, point, status)
      if (status /= status_ok) return
      m = size(point)
      allocate (coupling(m, m), change(m, 2), force(size(ua) - 1, 2), stat=info)
      if (info /= 0) status = status_out_of_memory
      if (info /= 0) return
      call find_answers(store, point, event, place, handle, fresh, value, n, status)
      if (status /= status_ok .or. m == 0) return
      coupling(:, :) = -store%answer
      do i = 1, m
         coupling(i, i) = coupling(i, i) + 1.0_wp
         change(i, :) = [product_of(point(i)%law, point(i), ua(1:)), product_of(point(i)%law, point(i), ub(1:))] &
            - point(i)%held
      end do
      call eliminate(coupling, change, status)
      if (status /= status_ok) return
      force = 0.0_wp
      do j = 1, m
         do i = 1, 2
            call add_force(point(j)%force * change(j, i), point(j), force(:, i))
         end do
         select type (group => holders(point(j)%group)%group)
         class is (point_group)
            call group%hold(point(j)%point, point(j)%held + change(j, :))
         end select
      end do
      fh(1:, :) = fh(1:, :) + force
      call solve(handle, fresh, value, force(1:n, :), status)
      ua(1:n) = ua(1:n) + force(1:n, 1)
      ub(1:n) = ub(1:n) + force(1:n, 2)
   end subroutine friction_balance

   !> The points of all groups that slide
   subroutine find_sliders(holders, point, status)
      type(group_holder), intent(in) :: holders(:)
      type(slider), allocatable, intent(out) :: point(:)
      integer(c_int), intent(out) :: status
      integer :: g, m, info
      m = 0
      do g = 1, size(holders)
         select type (group => holders(g)%group)
         class is (point_group)
            m = m + group%sliding()
         end select
      end do
      allocate (point(m), stat=info)
      status = merge(status_ok, status_out_of_memory, info == 0)
      if (info /= 0) return
      m = 0
      do g = 1, size(holders)
         select type (group => holders(g)%group)
         class is (point_group)
            call group%sliders(point, m)
            point(m - group%sliding() + 1:m)%group = g
         end select
      end do
   end subroutine find_sliders

   !> Bring the stored answers to the points that slide now and to the factor as it is
   subroutine find_answers(store, point, event, place, handle, fresh, value, n, status)
      type(friction_store), intent(inout) :: store
      type(slider), intent(in) :: point(:)
      type(event_vectors), intent(in) :: event
      integer, intent(in) :: place(2)
      type(c_ptr), intent(in) :: handle
      logical, intent(in) :: fresh
      real(wp), intent(in) :: value(:)
      integer, intent(in) :: n                 !! equations
      integer(c_int), intent(out) :: status
      real(wp), allocatable :: answer(:, :), z(:, :), x(:, :)
      real(wp) :: small(most_rank, most_rank), left(most_rank)
      integer :: old(size(point)), i, j, k, m, info

      m = size(point)
      old = 0
      if (store%known) then
         k = 1
         do i = 1, m    ! both lists are in the order of groups and points
            if (all([point(i)%group, point(i)%point] == place)) cycle
            do while (k <= size(store%point))
               if (store%point(k)%group > point(i)%group) exit
               if (store%point(k)%group == point(i)%group .and. store%point(k)%point >= point(i)%point) exit
               k = k + 1
            end do
            if (k > size(store%point)) exit
            if (store%point(k)%group == point(i)%group .and. store%point(k)%point == point(i)%point) old(i) = k
         end do
      end if
      allocate (answer(m, m), z(n, max(event%rank, 1)), x(n, 2), stat=info)
      status = merge(status_ok, status_out_of_memory, info == 0)
      if (info /= 0) return
      do j = 1, m
         do i = 1, m
            if (old(i) > 0 .and. old(j) > 0) answer(i, j) = store%answer(old(i), old(j))
         end do
      end do
      if (any(old > 0) .and. .not. store%current) then
         z = 0.0_wp
         do k = 1, event%rank
            do i = 1, event%entries
               if (event%index(i) <= n) z(event%index(i), k) = event%w(i, k)
            end do
         end do
         call solve(handle, fresh, value, z, status)
         if (status /= status_ok) return
         do k = 1, event%rank
            do i = 1, event%rank
               small(i, k) = sum(event%w(1:event%entries, i) * z(min(event%index(1:event%entries), n), k), &
                  mask=event%index(1:event%entries) <= n)
            end do
            small(k, k) = small(k, k) + event%sign(k)
         end do
         do j = 1, m
            if (old(j) == 0) cycle
            do k = 1, event%rank
               left(k) = product_of(point(j)%force, point(j), z(:, k))
            end do
            call eliminate_one(small(1:event%rank, 1:event%rank), left(1:event%rank), status)
            if (status /= status_ok) return
            do i = 1, m
               if (old(i) == 0) cycle
               do k = 1, event%rank
                  answer(i, j) = answer(i, j) + product_of(point(i)%law, point(i), z(:, k)) * left(k)
               end do
            end do
         end do
      end if
      do j = 1, m
         if (old(j) > 0) cycle
         x = 0.0_wp
         call add_force(point(j)%force, point(j), x(:, 1))
         call add_force(point(j)%law, point(j), x(:, 2))
         call solve(handle, fresh, value, x, status)
         if (status /= status_ok) return
         do i = 1, m
            answer(i, j) = product_of(point(i)%law, point(i), x(:, 1))
            answer(j, i) = product_of(point(i)%force, point(i), x(:, 2))
         end do
      end do
      store%known = .true.
      store%current = .true.
      store%point = point
      call move_alloc(answer, store%answer)
   end subroutine find_answers

   !> Displacements of some loads
   subroutine solve(handle, fresh, value, x, status)
      type(c_ptr), intent(in) :: handle
      logical, intent(in) :: fresh
      real(wp), intent(in) :: value(:)
      real(wp), intent(inout), contiguous :: x(:, :)
      integer(c_int), intent(out) :: status
      integer :: j, last
      status = status_ok
      do j = 1, size(x, 2), most_vectors
         last = min(j + most_vectors - 1, size(x, 2))
         if (fresh) then
            status = extrados_sparse_plain(handle, value, int(last - j + 1, c_int), x(:, j:last))
         else
            status = extrados_sparse_solve(handle, int(last - j + 1, c_int), x(:, j:last))
         end if
         if (status /= status_ok) return
      end do
   end subroutine solve

   !> Add the entries of a point to forces of the equations
   pure subroutine add_force(entries, point, force)
      real(wp), intent(in) :: entries(:)
      type(slider), intent(in) :: point
      real(wp), intent(inout) :: force(:)
      integer :: i
      do i = 1, size(entries)
         associate (q => point%index(i))
            if (q > 0 .and. q <= size(force)) force(q) = force(q) + entries(i)
         end associate
      end do
   end subroutine add_force

   !> Product of the entries of a point with displacements of the equations
   pure function product_of(entries, point, u) result(total)
      real(wp), intent(in) :: entries(:)
      type(slider), intent(in) :: point
      real(wp), intent(in) :: u(:)
      real(wp) :: total
      integer :: i
      total = 0.0_wp
      do i = 1, size(entries)
         if (point%index(i) > 0 .and. point%index(i) <= size(u)) total = total + entries(i) * u(point%index(i))
      end do
   end function product_of

   !> See eliminate, for one right side; the matrix stays
   pure subroutine eliminate_one(a, b, status)
      real(wp), intent(in) :: a(:, :)
      real(wp), intent(inout) :: b(:)
      integer(c_int), intent(out) :: status
      real(wp) :: copy(size(a, 1), size(a, 1)), side(size(b), 1)
      copy = a
      side(:, 1) = b
      call eliminate(copy, side, status)
      b = side(:, 1)
   end subroutine eliminate_one

   !> Gaussian elimination with row pivots; the right sides become the answers
   pure subroutine eliminate(a, b, status)
      real(wp), intent(inout) :: a(:, :)
      real(wp), intent(inout) :: b(:, :)
      integer(c_int), intent(out) :: status
      real(wp) :: factor, row(size(a, 1)), side(size(b, 2))
      integer :: i, k, best
      status = status_ok
      do k = 1, size(a, 1)
         best = k - 1 + maxloc(abs(a(k:, k)), dim=1)
         if (.not. abs(a(best, k)) > least_pivot) then
            status = status_not_positive_definite
            return
         end if
         if (best /= k) then
            row = a(k, :)
            a(k, :) = a(best, :)
            a(best, :) = row
            side = b(k, :)
            b(k, :) = b(best, :)
            b(best, :) = side
         end if
         do i = k + 1, size(a, 1)
            factor = a(i, k) / a(k, k)
            if (.not. abs(factor) > 0.0_wp) cycle
            a(i, k:) = a(i, k:) - factor * a(k, k:)
            b(i, :) = b(i, :) - factor * b(k, :)
         end do
      end do
      do k = size(a, 1), 1, -1
         b(k, :) = b(k, :) / a(k, k)
         do i = 1, k - 1
            b(i, :) = b(i, :) - a(i, k) * b(k, :)
         end do
      end do
   end subroutine eliminate

end module sla_friction
