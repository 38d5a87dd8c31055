!> Coulomb friction of all joints that slide, at once.
!>
!> Where a joint slides, its friction is proportional to the pressure across it at the same point: a stiffness that is
!> not symmetric, beside the symmetric one K that is factorised. The force f h by which the point differs from a spring
!> follows the displacements, h = r.u. The points that slide are few: with F and R the columns f and rows r of all,
!>
!>     (I - R inv(K) F) dh = R u - h,     u <- u + inv(K) F dh
!>
!> for the constant loads and those per unit multiplier alike (Woodbury's formula). So friction is exact between events.
!> Both f and r are made of the two vectors of a point whose products with u are its jumps, n across and t along the
!> joint. The flexibilities n inv(K) t and t inv(K) t between all points that have slid are kept from event to event: an
!> event changes K by a few vectors, K_old = K + W S W', which adds n Z inv(inv(S) + W' Z) Z' t with Z = inv(K) W.
module sla_friction
   use common_kinds, only : wp
   use common_status, only : status_ok, status_not_positive_definite, status_out_of_memory
   use sla_group, only : event_vectors, friction_group, group_holder, most_rank, slider
   use sla_stiffness, only : stiffness_matrix, stiffness_solve
   use, intrinsic :: iso_c_binding, only : c_int
   implicit none
   private
   public :: friction_store, friction_balance, friction_flexibility, friction_follow
   public :: eliminate_system, find_sliders, product_of

   !> Pivot of the unsymmetric system, whose diagonal is near one, below which the joints slide on without more load
   real(wp), parameter :: least_pivot = 1.0e-9_wp
   !> Right sides of one solution
   integer, parameter :: most_vectors = 4
   !> Points that are kept though they slide no more, over those that do, and some more
   integer, parameter :: most_kept = 2, some = 50

   !> Points that have slid, and what their forces do to their jumps
   type :: friction_store
      logical :: known = .false.                  !! there are flexibilities,
      logical :: current = .false.                !! and they are those of the factor as it is
      type(slider), allocatable :: point(:)
      real(wp), allocatable :: jump(:, :, :)      !! (2, to, from) across and along, of a unit force along [m/N]
   end type friction_store

contains

   !> Forces of sliding friction and displacements that balance with them
   subroutine friction_balance(store, holders, event, stiffness, ua, ub, fh, status)
      type(friction_store), intent(inout) :: store
      type(group_holder), intent(inout) :: holders(:)
      type(event_vectors), intent(in) :: event !! by which the factor changed since the last balance
      type(stiffness_matrix), intent(in) :: stiffness
      real(wp), intent(inout) :: ua(0:)        !! under the constant loads; beyond the equations supports that move [m]
      real(wp), intent(inout) :: ub(0:)        !! per unit multiplier [m]
      real(wp), intent(inout) :: fh(0:, :)     !! (0:, 2) forces of friction, constant and per unit multiplier [N]
      integer(c_int), intent(out) :: status    !! not_positive_definite: what slides is a mechanism; nothing was changed
      type(slider), allocatable :: point(:)
      real(wp), allocatable :: coupling(:, :), change(:, :), force(:, :), answer(:, :)
      integer, allocatable :: at(:)
      integer :: i, j, m, n, info

      n = size(stiffness%start) - 1
      call find_sliders(holders, point, status)
      if (status /= status_ok) return
      m = size(point)
      allocate (coupling(m, m), change(m, 2), force(size(ua) - 1, 2), answer(n, 2), at(m), stat=info)
      if (info /= 0) status = status_out_of_memory
      if (info /= 0) return
      call friction_flexibility(store, point, event, stiffness, at, status)
      if (status /= status_ok .or. m == 0) return
      do j = 1, m
         do i = 1, m
            coupling(i, j) = point(j)%area * dot_product(point(i)%law, store%jump(:, at(i), at(j)))
         end do
         coupling(j, j) = coupling(j, j) + 1.0_wp
         change(j, :) = point(j)%law(1) * [product_of(point(j)%across, point(j), ua(1:)), &
            product_of(point(j)%across, point(j), ub(1:))] + point(j)%law(2) * &
            [product_of(point(j)%slip, point(j), ua(1:)), product_of(point(j)%slip, point(j), ub(1:))] - point(j)%held
      end do
      call eliminate_system(coupling, change, status)
      if (status /= status_ok) return
      force = 0.0_wp
      do j = 1, m
         do i = 1, 2
            call add_force(-point(j)%area * change(j, i) * point(j)%slip, point(j), force(:, i))
         end do
         select type (group => holders(point(j)%group)%group)
         class is (friction_group)
            call group%set_held(point(j)%point, point(j)%held + change(j, :))
         end select
      end do
      fh(1:, :) = fh(1:, :) + force
      answer(:, :) = force(1:n, :)
      call solve_vectors(stiffness, answer, status)
      ua(1:n) = ua(1:n) + answer(:, 1)
      ub(1:n) = ub(1:n) + answer(:, 2)
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
         class is (friction_group)
            m = m + group%sliding()
         end select
      end do
      allocate (point(m), stat=info)
      status = merge(status_ok, status_out_of_memory, info == 0)
      if (info /= 0) return
      m = 0
      do g = 1, size(holders)
         select type (group => holders(g)%group)
         class is (friction_group)
            call group%sliders(point, m)
            point(m - group%sliding() + 1:m)%group = g
         end select
      end do
   end subroutine find_sliders

   !> Where in the store some points are, with the flexibilities between them of the factor as it is
   subroutine friction_flexibility(store, point, event, stiffness, at, status)
      type(friction_store), intent(inout) :: store
      type(slider), intent(in) :: point(:)
      type(event_vectors), intent(in) :: event
      type(stiffness_matrix), intent(in) :: stiffness
      integer, intent(out) :: at(:)            !! (points)
      integer(c_int), intent(out) :: status
      type(slider), allocatable :: all_of(:)
      real(wp), allocatable :: jump(:, :, :), x(:, :)
      logical, allocatable :: wanted(:)
      integer, allocatable :: kept(:)
      integer :: i, j, k, old, count, info

      call friction_follow(store, event, stiffness, status)
      if (status /= status_ok) return
      old = 0
      if (store%known) old = size(store%point)
      allocate (wanted(old), kept(old), stat=info)
      if (info /= 0) status = status_out_of_memory
      if (info /= 0) return
      wanted = .false.
      at = 0
      do i = 1, size(point)
         do k = 1, old
            if (store%point(k)%point /= point(i)%point .or. store%point(k)%group /= point(i)%group) cycle
            at(i) = k
            wanted(k) = .true.
            exit
         end do
      end do
      if (old <= most_kept * size(point) + some) wanted = .true.
      if (all(at > 0) .and. all(wanted) .and. store%known) return
      count = 0
      do k = 1, old
         if (.not. wanted(k)) cycle
         count = count + 1
         kept(count) = k
         where (at == k) at = count
      end do
      i = count
      do k = 1, size(at)
         if (at(k) == 0) count = count + 1
      end do
      allocate (all_of(count), jump(2, count, count), x(size(stiffness%start) - 1, 2), stat=info)
      if (info /= 0) status = status_out_of_memory
      if (info /= 0) return
      do k = 1, i
         all_of(k) = store%point(kept(k))
         do j = 1, i
            jump(:, j, k) = store%jump(:, kept(j), kept(k))
         end do
      end do
      do k = 1, size(point)
         if (at(k) > 0) cycle
         i = i + 1
         at(k) = i
         all_of(i) = point(k)
         x = 0.0_wp
         call add_force(point(k)%slip, point(k), x(:, 1))
         call add_force(point(k)%across, point(k), x(:, 2))
         call solve_vectors(stiffness, x, status)
         if (status /= status_ok) return
         do j = 1, i
            jump(:, j, i) = [product_of(all_of(j)%across, all_of(j), x(:, 1)), &
               product_of(all_of(j)%slip, all_of(j), x(:, 1))]
            jump(:, i, j) = [product_of(all_of(j)%slip, all_of(j), x(:, 2)), jump(2, j, i)]
         end do
      end do
      store%known = .true.
      store%current = .true.
      call move_alloc(all_of, store%point)
      call move_alloc(jump, store%jump)
   end subroutine friction_flexibility

   !> The flexibilities after an event, from those before it
   subroutine friction_follow(store, event, stiffness, status)
      type(friction_store), intent(inout) :: store
      type(event_vectors), intent(in) :: event
      type(stiffness_matrix), intent(in) :: stiffness
      integer(c_int), intent(out) :: status
      real(wp), allocatable :: z(:, :), moved(:, :, :), copy(:, :), left(:, :)
      real(wp) :: small(most_rank, most_rank)
      integer :: i, j, k, m, n, r, info

      n = size(stiffness%start) - 1
      status = status_ok
      if (.not. store%known .or. store%current) return
      store%known = .false.      ! until it has succeeded
      r = event%rank
      m = size(store%point)
      allocate (z(n, max(r, 1)), moved(2, r, m), copy(r, r), left(r, 1), stat=info)
      if (info /= 0) status = status_out_of_memory
      if (info /= 0) return
      z = 0.0_wp
      do k = 1, r
         do i = 1, event%entries
            if (event%index(i) <= n) z(event%index(i), k) = event%w(i, k)
         end do
      end do
      if (r > 0) call solve_vectors(stiffness, z, status)
      if (status /= status_ok) return
      do k = 1, r
         do i = 1, r
            small(i, k) = 0.0_wp
            do j = 1, event%entries
               if (event%index(j) <= n) small(i, k) = small(i, k) + event%w(j, i) * z(event%index(j), k)
            end do
         end do
         small(k, k) = small(k, k) + event%sign(k)
         do i = 1, m
            moved(:, k, i) = [product_of(store%point(i)%across, store%point(i), z(:, k)), &
               product_of(store%point(i)%slip, store%point(i), z(:, k))]
         end do
      end do
      do j = 1, m
         copy(:, :) = small(1:r, 1:r)
         left(:, 1) = moved(2, :, j)
         call eliminate_system(copy, left, status)
         if (status /= status_ok) return
         do i = 1, m
            do k = 1, r
               store%jump(:, i, j) = store%jump(:, i, j) + moved(:, k, i) * left(k, 1)
            end do
         end do
      end do
      store%known = .true.
      store%current = .true.
   end subroutine friction_follow

   !> Displacements of some loads
   subroutine solve_vectors(stiffness, x, status)
      type(stiffness_matrix), intent(in) :: stiffness
      real(wp), intent(inout), contiguous :: x(:, :)
      integer(c_int), intent(out) :: status
      integer :: j, last
      status = status_ok
      do j = 1, size(x, 2), most_vectors
         last = min(j + most_vectors - 1, size(x, 2))
         call stiffness_solve(stiffness, x(:, j:last), status)
         if (status /= status_ok) return
      end do
   end subroutine solve_vectors

   !> Add the entries of a point to forces of the equations
   pure subroutine add_force(entries, point, force)
      real(wp), intent(in) :: entries(:)
      type(slider), intent(in) :: point
      real(wp), intent(inout) :: force(:)
      integer :: i
      do i = 1, point%entries
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
      do i = 1, point%entries
         if (point%index(i) > 0 .and. point%index(i) <= size(u)) total = total + entries(i) * u(point%index(i))
      end do
   end function product_of

   !> Gaussian elimination with row pivots, column by column; the right sides become the answers
   pure subroutine eliminate_system(a, b, status)
      real(wp), intent(inout), contiguous :: a(:, :)
      real(wp), intent(inout), contiguous :: b(:, :)
      integer(c_int), intent(out) :: status
      integer :: j, k, n, best
      status = status_ok
      n = size(a, 1)
      do k = 1, n
         best = k - 1 + maxloc(abs(a(k:, k)), dim=1)
         if (.not. abs(a(best, k)) > least_pivot) then
            status = status_not_positive_definite
            return
         end if
         if (best /= k) then
            do j = k, n
               call swap_values(a(k, j), a(best, j))
            end do
            do j = 1, size(b, 2)
               call swap_values(b(k, j), b(best, j))
            end do
         end if
         a(k + 1:, k) = a(k + 1:, k) / a(k, k)
         do j = k + 1, n
            if (abs(a(k, j)) > 0.0_wp) a(k + 1:, j) = a(k + 1:, j) - a(k, j) * a(k + 1:, k)
         end do
         do j = 1, size(b, 2)
            b(k + 1:, j) = b(k + 1:, j) - b(k, j) * a(k + 1:, k)
         end do
      end do
      do j = 1, size(b, 2)
         do k = n, 1, -1
            b(k, j) = b(k, j) / a(k, k)
            b(1:k - 1, j) = b(1:k - 1, j) - b(k, j) * a(1:k - 1, k)
         end do
      end do
   end subroutine eliminate_system

   pure subroutine swap_values(a, b)
      real(wp), intent(inout) :: a, b
      real(wp) :: kept
      kept = a
      a = b
      b = kept
   end subroutine swap_values

end module sla_friction
