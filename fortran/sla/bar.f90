!> Bars of two nodes with saw-tooth softening, and linear springs.
module sla_bar
   use common_kinds, only : wp
   use common_lists, only : code_tension => sla_event_tension, code_compression => sla_event_compression
   use common_status, only : status_ok, status_out_of_memory, status_bad_geometry
   use sla_group, only : element_group, point_group, scan_result, event_vectors, material_options, unbounded, &
      admitted, linear_bound
   use sla_tables, only : tooth_tables, tooth_tables_copy
   use, intrinsic :: iso_c_binding, only : c_int
   implicit none
   private
   public :: bar_group, bar_group_new, spring_group, spring_group_new

   !> Bars; the damage of a bar is its tension and its compression tooth
   type, extends(point_group) :: bar_group
      real(wp), allocatable :: gradient(:, :)         !! (freedoms, elements) strain per displacement [1/m]
      real(wp), allocatable :: volume(:)              !! [m^3]
      real(wp), allocatable :: young(:)               !! [Pa]
      integer(c_int), allocatable :: table(:)
      integer(c_int), allocatable :: crush_table(:)
      integer(c_int), allocatable :: tooth(:, :)      !! (2, elements) tension, compression
      real(wp), allocatable :: modulus(:)             !! [Pa]
      type(tooth_tables) :: teeth
   contains
      procedure :: matrix => bar_matrix
      procedure :: force => bar_force
      procedure :: scan => bar_scan
      procedure :: damage => bar_damage
      procedure :: report => bar_report
      procedure :: state => bar_state
      procedure :: margin => bar_margin
   end type bar_group

   !> Springs between two freedoms, or one and the ground; they have no integration points
   type, extends(element_group) :: spring_group
      real(wp), allocatable :: stiffness(:)           !! [N/m]
   contains
      procedure :: matrix => spring_matrix
      procedure :: force => spring_force
   end type spring_group

contains

   !> Bars without damage
   subroutine bar_group_new(xy, connect, area, young, table, crush_table, teeth, options, group, bad, status)
      real(wp), intent(in) :: xy(:, :)             !! (2 or 3, nodes) [m]
      integer(c_int), intent(in) :: connect(:, :)  !! (2, elements), 1-based
      real(wp), intent(in) :: area(:)              !! [m^2]
      real(wp), intent(in) :: young(:)             !! [Pa]
      integer(c_int), intent(in) :: table(:)
      integer(c_int), intent(in) :: crush_table(:)
      type(tooth_tables), intent(in) :: teeth
      type(material_options), intent(in) :: options
      type(bar_group), intent(out) :: group
      integer(c_int), intent(out) :: bad
      integer(c_int), intent(out) :: status
      real(wp) :: d(size(xy, 1)), length
      integer :: e, n, info

      n = size(connect, 2)
      bad = 0
      status = status_out_of_memory
      group%elements = n
      group%points = n
      group%freedoms = 2 * size(xy, 1)
      group%directions = 1
      group%options = options
      call tooth_tables_copy(teeth, group%teeth, status)
      if (status /= status_ok) return
      status = status_out_of_memory
      allocate (group%gradient(group%freedoms, n), group%volume(n), group%young(n), group%table(n), &
         group%crush_table(n), group%tooth(2, n), group%modulus(n), stat=info)
      if (info /= 0) return
      group%young(:) = young
      group%modulus(:) = young
      group%table(:) = table
      group%crush_table(:) = crush_table
      group%tooth = 1
      do e = 1, n
         d = xy(:, connect(2, e)) - xy(:, connect(1, e))
         length = norm2(d)
         if (.not. length > 0.0_wp) then
            bad = int(e, c_int)
            status = status_bad_geometry
            return
         end if
         group%gradient(:, e) = [-d, d] / length**2
         group%volume(e) = area(e) * length
      end do
      status = status_ok
   end subroutine bar_group_new

   pure subroutine bar_matrix(group, element, k)
      class(bar_group), intent(in) :: group
      integer, intent(in) :: element
      real(wp), intent(out) :: k(:, :)
      integer :: i, n
      n = group%freedoms
      k = 0.0_wp
      do i = 1, n
         k(1:n, i) = group%volume(element) * group%modulus(element) * group%gradient(:, element) &
            * group%gradient(i, element)
      end do
   end subroutine bar_matrix

   pure subroutine bar_force(group, u, f)
      class(bar_group), intent(in) :: group
      real(wp), intent(in) :: u(0:)
      real(wp), intent(inout) :: f(0:)
      real(wp) :: part(6), local(6)
      integer :: e, i
      do e = 1, group%elements
         call group%gather(e, u, local)
         part(1:group%freedoms) = group%volume(e) * bar_stress(group, e, local) * group%gradient(:, e)
         do i = 1, group%freedoms
            f(group%equation(i, e)) = f(group%equation(i, e)) + part(i) * group%factor(i, e)
         end do
      end do
   end subroutine bar_force

   !> Stress under the displacements of its ends [Pa]
   pure function bar_stress(group, e, local) result(stress)
      class(bar_group), intent(in) :: group
      integer, intent(in) :: e
      real(wp), intent(in) :: local(:)
      real(wp) :: stress
      stress = group%modulus(e) * dot_product(group%gradient(:, e), local(1:group%freedoms))
   end function bar_stress

   !> Strengths in tension and compression [Pa]
   pure function bar_limits(group, e) result(limit)
      class(bar_group), intent(in) :: group
      integer, intent(in) :: e
      real(wp) :: limit(2), tension, compression
      tension = group%teeth%modulus_of(group%table(e), group%tooth(1, e), group%young(e), group%options%floor)
      compression = group%teeth%modulus_of(group%crush_table(e), group%tooth(2, e), group%young(e), group%options%floor)
      limit(1) = group%teeth%strength_of(group%table(e), group%tooth(1, e), group%modulus(e) / tension)
      limit(2) = group%teeth%strength_of(group%crush_table(e), group%tooth(2, e), group%modulus(e) / compression)
   end function bar_limits

   pure subroutine bar_scan(group, first, last, ua, ub, lambda, noise, found)
      class(bar_group), intent(in) :: group
      integer, intent(in) :: first
      integer, intent(in) :: last
      real(wp), intent(in) :: ua(0:)
      real(wp), intent(in) :: ub(0:)
      real(wp), intent(in) :: lambda
      real(wp), intent(in) :: noise
      type(scan_result), intent(inout) :: found
      real(wp) :: la(6), lb(6), sa, sb, limit(2)
      integer :: e
      do e = first, last
         if (group%table(e) == 0 .and. group%crush_table(e) == 0) cycle
         call group%gather(e, ua, la)
         call group%gather(e, ub, lb)
         sa = bar_stress(group, e, la)
         sb = bar_stress(group, e, lb)
         limit = bar_limits(group, e)
         if (limit(1) < unbounded) then
           call linear_bound(sa, sb, limit(1), limit(1), lambda, noise, e, code_tension, found)
         end if
         if (limit(2) < unbounded) then
           call linear_bound(-sa, -sb, limit(2), limit(2), lambda, noise, e, code_compression, found)
         end if
      end do
   end subroutine bar_scan

   !> See point_group
   pure subroutine bar_margin(group, first, last, ua, ub, lambda, least)
      class(bar_group), intent(in) :: group
      integer, intent(in) :: first
      integer, intent(in) :: last
      real(wp), intent(in) :: ua(0:)
      real(wp), intent(in) :: ub(0:)
      real(wp), intent(in) :: lambda(:)
      real(wp), intent(inout) :: least(:)
      real(wp) :: la(6), lb(6), stress, limit(2), share
      integer :: e, j
      do e = first, last
         if (group%table(e) == 0 .and. group%crush_table(e) == 0) cycle
         call group%gather(e, ua, la)
         call group%gather(e, ub, lb)
         share = sqrt(group%volume(e) / group%modulus(e))
         limit = bar_limits(group, e)
         do j = 1, size(lambda)
            stress = bar_stress(group, e, la) + lambda(j) * bar_stress(group, e, lb)
            if (limit(1) < unbounded) least(j) = min(least(j), share * (limit(1) - stress))
            if (limit(2) < unbounded) least(j) = min(least(j), share * (limit(2) + stress))
         end do
      end do
   end subroutine bar_margin

   pure subroutine bar_damage(group, point, code, lambda, ua, ub, event, tooth)
      class(bar_group), intent(inout) :: group
      integer, intent(in) :: point
      integer, intent(in) :: code
      real(wp), intent(in) :: lambda
      real(wp), intent(in) :: ua(0:)
      real(wp), intent(in) :: ub(0:)
      type(event_vectors), intent(out) :: event
      integer, intent(out) :: tooth
      real(wp) :: before
      integer :: k
      associate (unused_load => lambda, unused_a => ua, unused_b => ub)   ! a bar's axis is known beforehand
      end associate
      k = merge(1, 2, code == code_tension)
      before = group%modulus(point)
      group%tooth(k, point) = group%tooth(k, point) + 1_c_int
      tooth = int(group%tooth(k, point))
      call bar_refresh(group, point)
      event%rank = 1
      event%sign(1) = sign(1.0_wp, before - group%modulus(point))
      call group%spread(point, sqrt(group%volume(point) * abs(before - group%modulus(point))) &
         * group%gradient(:, point), event, 1)
   end subroutine bar_damage

   !> Modulus of a bar from its damage
   pure subroutine bar_refresh(group, e)
      class(bar_group), intent(inout) :: group
      integer, intent(in) :: e
      group%modulus(e) = min( &
         group%teeth%modulus_of(group%table(e), group%tooth(1, e), group%young(e), group%options%floor), &
         group%teeth%modulus_of(group%crush_table(e), group%tooth(2, e), group%young(e), group%options%floor))
   end subroutine bar_refresh

   pure subroutine bar_state(group, store, values)
      class(bar_group), intent(inout) :: group
      logical, intent(in) :: store
      real(wp), intent(inout) :: values(:, :)
      integer :: e
      if (store) then
         values = 0.0_wp
         values(4, :) = real(group%tooth(1, :), wp)
         values(6, :) = real(group%tooth(2, :), wp)
      else
         group%tooth(1, :) = nint(values(4, :), c_int)
         group%tooth(2, :) = nint(values(6, :), c_int)
         do e = 1, group%elements
            call bar_refresh(group, e)
         end do
      end if
   end subroutine bar_state

   !> Rows as of a plane point: the strain, the stress and the moduli of the bar's axis
   pure subroutine bar_report(group, ua, ub, lambda, noise, values)
      class(bar_group), intent(in) :: group
      real(wp), intent(in) :: ua(0:)
      real(wp), intent(in) :: ub(0:)
      real(wp), intent(in) :: lambda
      real(wp), intent(in) :: noise
      real(wp), intent(out) :: values(:, :)
      real(wp) :: la(6), lb(6), length
      type(scan_result) :: found
      integer :: e, k
      values = 0.0_wp
      do e = 1, group%elements
         call group%gather(e, ua, la)
         call group%gather(e, ub, lb)
         values(4, e) = bar_stress(group, e, la + lambda * lb)
         values(1, e) = values(4, e) / group%modulus(e)
         k = 1 + group%freedoms / 2
         length = 1.0_wp / norm2(group%gradient(k:, e))
         values(7:8, e) = group%gradient(k:k + 1, e) * length
         values(9, e) = group%modulus(e) / group%young(e)
         values(10, e) = 1.0_wp
         values(11, e) = real(group%tooth(1, e), wp)
         values(12, e) = 1.0_wp
         found = scan_result()
         call bar_scan(group, e, e, ua, ub, lambda, noise, found)
         values(13:14, e) = admitted(found)
         values(15, e) = group%volume(e)
         values(16, e) = real(group%tooth(2, e), wp)
         values(17, e) = 1.0_wp
      end do
   end subroutine bar_report

   !> Springs between freedoms of the given equations
   subroutine spring_group_new(stiffness, group, status)
      real(wp), intent(in) :: stiffness(:)        !! [N/m]
      type(spring_group), intent(out) :: group
      integer(c_int), intent(out) :: status
      integer :: info
      group%elements = size(stiffness)
      group%freedoms = 2
      allocate (group%stiffness(size(stiffness)), stat=info)
      status = merge(status_ok, status_out_of_memory, info == 0)
      if (info == 0) group%stiffness(:) = stiffness
   end subroutine spring_group_new

   pure subroutine spring_matrix(group, element, k)
      class(spring_group), intent(in) :: group
      integer, intent(in) :: element
      real(wp), intent(out) :: k(:, :)
      k = 0.0_wp
      k(1:2, 1:2) = group%stiffness(element) * reshape([1.0_wp, -1.0_wp, -1.0_wp, 1.0_wp], [2, 2])
   end subroutine spring_matrix

   pure subroutine spring_force(group, u, f)
      class(spring_group), intent(in) :: group
      real(wp), intent(in) :: u(0:)
      real(wp), intent(inout) :: f(0:)
      real(wp) :: local(2), pull
      integer :: e
      do e = 1, group%elements
         call group%gather(e, u, local)
         pull = group%stiffness(e) * (local(1) - local(2))
         f(group%equation(1, e)) = f(group%equation(1, e)) + pull * group%factor(1, e)
         f(group%equation(2, e)) = f(group%equation(2, e)) - pull * group%factor(2, e)
      end do
   end subroutine spring_force

end module sla_bar
