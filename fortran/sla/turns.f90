!> Which points slide on and which stick, all at once, where no change of a single one goes on.
!>
!> Friction makes the way of the structure depend on sets: a point that begins to slide may turn others back, and as
!> they stick, it may slide on. Changing one after the other then turns in a circle at one load. With the plastic slip
!> rate g of each point at its limit and the rate f at which its strength gains on its shear, both per unit multiplier,
!>
!>     g >= 0,  f >= 0,  g f = 0   at each point:  it slides, or it sticks
!>
!> is a linear complementarity problem. The forces h of the points beside their springs, u' = u0' + inv(K) F h, let
!> g = g0 + G h and f = f0 + H h, so that f = q + M g with M = H inv(G), q = f0 - M g0. It is solved by Lemke's pivots
!> (Cottle, Pang and Stone 1992, section 4.4). Where these end on a ray no motion goes on with more load: the load has
!> reached a limit that friction sets.
module sla_turns
   use common_kinds, only : wp
   use common_lists, only : code_slide => sla_event_slide, code_stick => sla_event_stick
   use common_status, only : status_ok, status_out_of_memory
   use sla_friction, only : friction_flexibility, friction_store, eliminate_system, find_sliders, product_of
   use sla_group, only : event_vectors, friction_group, group_holder, point_event, slider
   use sla_stiffness, only : stiffness_matrix
   use, intrinsic :: iso_c_binding, only : c_int
   implicit none
   private
   public :: friction_turns

contains

   !> The changes that let the structure go on with more load, all made at once
   subroutine friction_turns(store, holders, event, stiffness, lambda, ua, ub, change, found, status)
      type(friction_store), intent(inout) :: store
      type(group_holder), intent(in) :: holders(:)
      type(event_vectors), intent(in) :: event           !! by which the factor changed since the last balance
      type(stiffness_matrix), intent(in) :: stiffness
      real(wp), intent(in) :: lambda
      real(wp), intent(in) :: ua(0:)
      real(wp), intent(in) :: ub(0:)
      type(point_event), allocatable, intent(out) :: change(:)
      logical, intent(out) :: found                      !! false: no motion goes on with more load
      integer(c_int), intent(out) :: status
      type(slider), allocatable :: point(:)
      real(wp), allocatable :: g(:, :), f(:, :), g0(:), f0(:), matrix(:, :), side(:, :)
      type(point_event), allocatable :: turn(:)
      integer, allocatable :: at(:)
      logical, allocatable :: sliding(:)
      integer :: i, j, m, slides, count, info

      found = .false.
      call find_limited(holders, lambda, ua, ub, point, slides, status)
      if (status /= status_ok) return
      m = size(point)
      allocate (g(m, m), f(m, m), g0(m), f0(m), matrix(m, m), side(m, m + 1), sliding(m), turn(m), at(m), &
         stat=info)
      if (info /= 0) status = status_out_of_memory
      if (info /= 0 .or. m == 0) return
      call friction_flexibility(store, point, event, stiffness, at, status)
      if (status /= status_ok) return
      do i = 1, m
         associate (p => point(i))
            g0(i) = product_of(p%slip, p, ub(1:))
            f0(i) = p%spring * g0(i) + merge(p%held(2), 0.0_wp, i <= slides)   ! the shear
            do j = 1, m
               g(i, j) = -point(j)%area * store%jump(2, at(i), at(j))
               f(i, j) = p%spring * g(i, j) + merge(1.0_wp, 0.0_wp, i == j)
            end do
            ! The slip is measured by the stress that it would be if it were elastic
            g0(i) = p%sense * (p%elastic * g0(i) - f0(i))
            g(i, :) = p%sense * (p%elastic * g(i, :) - f(i, :))
            f0(i) = p%strength * product_of(p%across, p, ub(1:)) - p%sense * f0(i)
            do j = 1, m
               f(i, j) = -p%strength * point(j)%area * store%jump(1, at(i), at(j)) - p%sense * f(i, j)
            end do
         end associate
      end do
      side = 0.0_wp
      do i = 1, m
         side(i, i) = 1.0_wp
      end do
      side(:, m + 1) = -g0
      call eliminate_system(g, side, status)
      if (status /= status_ok) then     ! all of them stuck are a mechanism
         status = status_ok
         return
      end if
      matrix = 0.0_wp
      do j = 1, m
         do i = 1, m
            matrix(:, j) = matrix(:, j) + f(:, i) * side(i, j)
         end do
         f0(:) = f0 + f(:, j) * side(j, m + 1)
      end do
      call lemke(matrix, f0, sliding, found, status)
      if (status /= status_ok .or. .not. found) return
      count = 0
      do i = 1, m
         if (sliding(i) .eqv. i <= slides) cycle
         count = count + 1
         turn(count) = point_event(point(i)%group, point(i)%point, int(merge(code_slide, code_stick, sliding(i))))
      end do
      allocate (change(count), stat=info)
      if (info /= 0) status = status_out_of_memory
      if (info == 0) change(:) = turn(1:count)
   end subroutine friction_turns

   !> Points at the limit of their friction: those that slide, then those that have stuck at this very load
   subroutine find_limited(holders, lambda, ua, ub, point, slides, status)
      type(group_holder), intent(in) :: holders(:)
      real(wp), intent(in) :: lambda
      real(wp), intent(in) :: ua(0:)
      real(wp), intent(in) :: ub(0:)
      type(slider), allocatable, intent(out) :: point(:)
      integer, intent(out) :: slides
      integer(c_int), intent(out) :: status
      type(slider), allocatable :: sliding(:)
      type(slider) :: none(0)
      integer :: g, i, before, count, info
      slides = 0
      call find_sliders(holders, sliding, status)
      if (status /= status_ok) return
      slides = size(sliding)
      count = slides
      do g = 1, size(holders)
         select type (group => holders(g)%group)
         class is (friction_group)
            call group%turned_back(lambda, none, count)
         end select
      end do
      allocate (point(count), stat=info)
      if (info /= 0) status = status_out_of_memory
      if (info /= 0) return
      point(1:slides) = sliding
      count = slides
      do g = 1, size(holders)
         select type (group => holders(g)%group)
         class is (friction_group)
            before = count
            call group%turned_back(lambda, point, count)
            point(before + 1:count)%group = g
         end select
      end do
      do i = slides + 1, count
         associate (p => point(i))
            p%sense = sign(1.0_wp, p%spring * (product_of(p%slip, p, ua(1:)) + lambda * product_of(p%slip, p, ub(1:))) &
               + p%held(1))
         end associate
      end do
   end subroutine find_limited

   !> w = q + M z, w >= 0, z >= 0, w z = 0
   pure subroutine lemke(matrix, q, positive, found, status)
      real(wp), intent(in) :: matrix(:, :)
      real(wp), intent(in) :: q(:)
      logical, intent(out) :: positive(:)      !! z is in the solution's basis
      logical, intent(out) :: found            !! false: the pivots ended on a ray
      integer(c_int), intent(out) :: status
      integer, parameter :: rounds = 20
      real(wp), allocatable :: table(:, :)
      integer, allocatable :: basis(:)
      real(wp) :: ratio, least, unit
      integer :: m, i, enters, leaves, row, pivots, info

      m = size(q)
      status = status_ok
      positive = .false.
      found = .true.
      if (all(q >= 0.0_wp)) return
      ! Columns: w 1 to m, z m + 1 to 2 m, the artificial one, the right side
      allocate (table(m, 2 * m + 2), basis(m), stat=info)
      if (info /= 0) status = status_out_of_memory
      if (info /= 0) return
      table = 0.0_wp
      unit = maxval(abs(q))
      do i = 1, m
         table(i, i) = 1.0_wp
         basis(i) = i
      end do
      table(:, m + 1:2 * m) = -matrix / maxval(abs(matrix))
      table(:, 2 * m + 1) = -1.0_wp
      table(:, 2 * m + 2) = q / unit
      row = minloc(q, dim=1)
      enters = 2 * m + 1
      do pivots = 1, rounds * m
         leaves = basis(row)
         call pivot(table, row, enters)
         basis(row) = enters
         if (leaves == 2 * m + 1) then
            do i = 1, m
               if (basis(i) > m) positive(basis(i) - m) = .true.
            end do
            return
         end if
         enters = merge(leaves + m, leaves - m, leaves <= m)
         row = 0
         least = huge(1.0_wp)
         do i = 1, m
            if (table(i, enters) <= 1.0e-12_wp) cycle
            ratio = table(i, 2 * m + 2) / table(i, enters)
            if (ratio < least .or. (ratio <= least .and. basis(i) == 2 * m + 1)) then
               least = ratio
               row = i
            end if
         end do
         if (row == 0) exit
      end do
      found = .false.
   end subroutine lemke

   !> Gauss-Jordan step
   pure subroutine pivot(table, row, column)
      real(wp), intent(inout) :: table(:, :)
      integer, intent(in) :: row, column
      integer :: i
      table(row, :) = table(row, :) / table(row, column)
      do i = 1, size(table, 1)
         if (i /= row) table(i, :) = table(i, :) - table(i, column) * table(row, :)
      end do
   end subroutine pivot

end module sla_turns
